"""What docs/format.md says a decoder draws of a tile's model, bit for bit: one operation of IEEE 754 after the other,
over whole arrays, every pixel of every Gaussian. Slow and simple: what all other drawing is compared with.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from restoration_reader import network_of

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.model.quantization import step_fixed
from sgicodec.model.texture_symbols import TextureSymbols

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Any32 = Any  # a float32 or an array of them

CUTOFF, MIN_VARIANCE, PIXEL_VARIANCE = np.float32(3.5), np.float32(0.05), 0.1
LOG2E = np.float32(1.44269504)
PI = "3.14159265358979323846264338327950288419716939937510582097494459"


def f(value: Any) -> np.float32:
    """A number as a float32."""
    return np.float32(value)


# Elementary functions


def exp2(x: Any32) -> Any32:
    """2^x of float32."""
    x = np.minimum(np.asarray(x, np.float32), f(126))
    t = x + f(12582912)
    r = x - (t - f(12582912))
    p = np.full_like(x, f(1.32028596e-3))
    for term in (9.67495330e-3, 5.55104762e-2, 2.40221664e-1, 6.93146586e-1, 1.0):
        p = p * r + f(term)
    with np.errstate(over="ignore"):
        bits = p.view(np.uint32) + (t.view(np.uint32) << np.uint32(23))
    return np.where(x >= f(-126), bits.view(np.float32), f(0))


def sine_cosine(x: F32) -> tuple[F32, F32]:
    """Sine and cosine of float32."""
    t = x * f(0.63661977) + f(12582912)
    turns = t - f(12582912)
    quarter = t.view(np.uint32)
    r = ((x - turns * f(1.5703125)) - turns * f(4.8375129699707031e-4)) - turns * f(7.549789948768648e-8)
    rr = r * r
    s = f(-1.9515295891e-4) * rr + f(8.3321608736e-3)
    s = s * rr - f(1.6666654611e-1)
    s = s * rr * r + r
    c = f(2.443315711809948e-5) * rr - f(1.388731625493765e-3)
    c = c * rr + f(4.166664568298827e-2)
    c = c * rr * rr - f(0.5) * rr + f(1)
    swaps = quarter & np.uint32(1) != 0
    sine = np.where(quarter & np.uint32(2), -np.where(swaps, c, s), np.where(swaps, c, s))
    cosine = np.where((quarter + np.uint32(1)) & np.uint32(2), -np.where(swaps, s, c), np.where(swaps, s, c))
    return sine, cosine


def _taylor() -> tuple[list[float], list[float], list[float]]:
    """Terms of sin(πu) / u and cos(πu) in u², and of 2^x in x, rounded to nearest."""
    from decimal import Decimal, localcontext

    with localcontext() as context:
        context.prec = 60
        pi, ln2 = Decimal(PI), Decimal(2).ln()
        sine = [float((-1) ** k * pi ** (2 * k + 1) / math.factorial(2 * k + 1)) for k in range(8)]
        cosine = [float((-1) ** k * pi ** (2 * k) / math.factorial(2 * k)) for k in range(9)]
        return sine, cosine, [float(ln2**k / math.factorial(k)) for k in range(14)]


def power_of_two(k: int) -> float:
    """2^(k / 32)."""
    from decimal import Decimal, localcontext

    with localcontext() as context:
        context.prec = 60
        return math.ldexp(float(Decimal(2) ** (Decimal(k % 32) / 32)), k // 32)


SINE, COSINE, EXPONENTIAL = _taylor()


def polynomial(terms: list[float], x: float) -> float:
    """The sum of terms[i] x^i."""
    total = terms[-1]
    for term in reversed(terms[:-1]):
        total = total * x + term
    return total


def sine_pi(u: float, further: int = 0) -> float:
    """sin(πu), or cos(πu) with further = 1: a quarter of a turn further."""
    quarter = math.floor(2 * u + 0.5)
    r = u - 0.5 * quarter
    turn = (quarter + further) % 4
    value = polynomial(COSINE, r * r) if turn % 2 else r * polynomial(SINE, r * r)
    return -value if turn >= 2 else value


def exp2_of(x: float) -> float:
    """2^x of float64."""
    whole = math.floor(x + 0.5)
    return math.ldexp(polynomial(EXPONENTIAL, x - whole), whole) if x >= -1022 else 0.0


# Views


@dataclass(frozen=True)
class View:
    """Output pixels along one axis of a tile: pixel i has its centre at (offset + first + i + 1/2) / scale."""

    start: float
    scale: float
    count: int

    @property
    def offset(self) -> float:
        """Of a pixel, in whole multiples of 2^-16."""
        return self._at - math.floor(self._at)

    @property
    def first(self) -> int:
        """The first pixel."""
        return math.floor(self._at)

    @property
    def _at(self) -> float:
        return math.floor(self.start * self.scale * 65536 + 0.5) / 65536

    def place(self, pixel: int, inside: float) -> float:
        """In the tile, of a place inside an output pixel."""
        return (self.offset + (self.first + pixel) + inside) / self.scale

    @property
    def is_plain(self) -> bool:
        """Whether its pixels are the tile's."""
        return self.scale == 1 and self.offset == 0


# Gaussians and channels


def sample_mix(luma_space: bool) -> F32:
    """F [3, 3]: samples of channels."""
    one = np.longdouble(1)
    luma, difference, ends = np.sqrt(one / 3), np.sqrt(one / 2), np.sqrt(one / 6)
    rows = [[luma, difference, -ends], [luma, 0 * one, 2 * ends], [luma, -difference, -ends]]
    if luma_space:
        red, wide = np.sqrt(one * 2) / 1.3, np.sqrt(one * 2 / 3)
        rows = [[luma, red, -wide], [luma, -red / 5, wide * 3 / 5], [luma, -red, -wide]]
    return np.array(rows).astype(np.float32)


def products(matrix: Any, values: Any) -> Any:
    """Σ_k matrix[c][k] values[k], from 0 on in the order of k."""
    sums = []
    for row in matrix:
        total = np.zeros_like(values[0])
        for share, value in zip(row, values, strict=True):
            total = total + share * value
        sums.append(total)
    return sums


def log_covariance(shape: Any, area: F32) -> tuple[F32, F32, F32]:
    """xx, xy, yy of log-covariances (a, b, c)."""
    a, b, c = shape
    t = b * b + c * c
    shrink = np.where(t < f(144), f(1), f(12) / np.sqrt(np.maximum(t, f(144))))
    a, b, c, t = np.clip(a, f(-12), f(12)), b * shrink, c * shrink, np.minimum(t, f(144))
    scale = exp2(a * (f(2) * LOG2E))
    r = np.sqrt(np.maximum(t, f(1e-4)))
    grow = exp2(r * (f(2) * LOG2E))
    fall = f(1) / grow
    cosh, sinhc = f(0.5) * (grow + fall), f(0.5) * (grow - fall) / r
    even = np.where(t < f(0.02), f(1) + t * (f(2) + t * (f(0.6666667) + t * f(0.0888889))), cosh)
    odd = np.where(t < f(0.02), f(2) + t * (f(1.3333333) + t * (f(0.2666667) + t * f(0.0253968))), sinhc)
    even, odd = scale * even, scale * odd
    return area * (even + odd * b) + MIN_VARIANCE, area * odd * c, area * (even - odd * b) + MIN_VARIANCE


def rotated_covariance(shape: Any, reach: tuple[F32, F32]) -> tuple[F32, F32, F32]:
    """xx, xy, yy of two sizes before their sigmoid and an angle."""
    squared = []
    for size, most in zip(shape[:2], reach, strict=True):
        deviation = most * (f(1) / (f(1) + exp2(-LOG2E * np.clip(size, f(-12), f(12)))))
        squared.append(deviation * deviation)
    sine, cosine = sine_cosine(shape[2])
    xx = cosine * cosine * squared[0] + sine * sine * squared[1]
    yy = sine * sine * squared[0] + cosine * cosine * squared[1]
    return xx + MIN_VARIANCE, cosine * sine * (squared[0] - squared[1]), yy + MIN_VARIANCE


def perceptron(features: Any, weights: dict[str, F32], name: str) -> Any:
    """W2 max(0, W1 f + b1) + b2."""
    hidden = products(weights[f"{name}.w1"], features)
    hidden = [np.maximum(value + bias, f(0)) for value, bias in zip(hidden, weights[f"{name}.b1"], strict=True)]
    said = products(weights[f"{name}.w2"], hidden)
    return [value + bias for value, bias in zip(said, weights[f"{name}.b2"], strict=True)]


def gaussians(header: Header, model: TileModel) -> tuple[F32, F32, F32]:
    """Means [N K, 2], covariances [N K, 3], colours [N K, C]."""
    spec, channels, n = header.spec, header.spec.channels, len(model.layout)
    values = model.decoded_values.astype(np.float32)
    group = {part.name: list(values[:, part.columns].T) for part in spec.groups}
    cell = model.layout.cell
    decoders = {key: np.ldexp(part.astype(np.float32), -model.decoder_shift) for key, part in model.decoders.items()}
    if decoders:
        colour, shape = (perceptron(group["feature"], decoders, name) for name in ("colour", "shape"))
    else:
        colour, shape = group["colour"], group["shape"]
    scales = [np.maximum(s, f(0)) for s in group["scales"]] if "scales" in group else [np.ones(n, np.float32)] * 4
    means, covariances, colours = [], [], []
    for k in range(spec.per_seed):
        own = colour[k * channels : (k + 1) * channels]
        colours.append(own)
        centre = [model.layout.corner[:, axis].astype(np.float32) + f(0.5) * cell for axis in range(2)]
        offset = group["offset"][2 * k : 2 * k + 2]
        means.append([centre[axis] + cell * offset[axis] * scales[axis] for axis in range(2)])
        bare = shape[3 * k : 3 * k + 3]
        if spec.plain:
            covariances.append(log_covariance(bare, cell * cell))
        else:
            covariances.append(rotated_covariance(bare, (cell * scales[2], cell * scales[3])))

    def by_gaussian(parts: list[Any]) -> F32:
        return np.array(parts, np.float32).transpose(2, 0, 1).reshape(n * spec.per_seed, -1)

    return by_gaussian(means), by_gaussian(covariances), by_gaussian(colours)


def rescaled(means: F32, covariances: F32, colours: F32, across: View, down: View) -> tuple[F32, F32, F32]:
    """In output pixels, from the tile's corner on."""
    sx, sy = across.scale, down.scale
    x = (means[:, 0] * np.float64(sx) - across.offset).astype(np.float32)
    y = (means[:, 1] * np.float64(sy) - down.offset).astype(np.float32)
    xx, xy, yy = (covariances.astype(np.float64) * [sx * sx, sx * sy, sy * sy]).T
    before = xx * yy - xy * xy
    xx, yy = xx + PIXEL_VARIANCE * max(0.0, 1 - sx * sx), yy + PIXEL_VARIANCE * max(0.0, 1 - sy * sy)
    fade = np.sqrt(np.where(before > 0, before / (xx * yy - xy * xy), 0.0))
    covariances = np.stack([xx, xy, yy], axis=1).astype(np.float32)
    return np.stack([x, y], axis=1), covariances, (colours * fade[:, None]).astype(np.float32)


def sum_of_gaussians(parts: tuple[F32, F32, F32], across: View, down: View) -> F32:
    """Σ colour · height [C, h, w], every Gaussian at every pixel."""
    means, covariances, colours = parts
    image = np.zeros((colours.shape[1], down.count, across.count), np.float32)
    least = exp2(f(-0.5) * LOG2E * CUTOFF * CUTOFF)
    columns = (np.arange(across.count) + across.first).astype(np.float32) + f(0.5)
    for mean, covariance, colour in zip(means, covariances, colours, strict=True):
        (x, y), (xx, xy, yy) = mean, covariance.astype(np.float64)
        det = xx * yy - xy * xy
        if not (xx > 0 and yy > 0 and det > 1e-6 * xx * yy and np.isfinite([det, x, y]).all()):
            continue
        side, fall, lean = f(-0.5 * np.float64(LOG2E) / xx), f(-0.5 * np.float64(LOG2E) * xx / det), f(xy / xx)
        ratio = exp2(f(2) * fall)
        top = math.floor(np.clip(y - CUTOFF * np.sqrt(covariance[2]) + f(0.5), f(-1e9), f(1e9)))
        span, headroom = 8, f(11.2) - f(0.85) * CUTOFF
        while span > 1 and f(span - 1) * np.sqrt(-fall) > headroom:
            span //= 2
        dx = columns - x
        ridge, beside = lean * dx, side * dx * dx
        height = rate = np.zeros_like(dx)
        first = max(top, top + (down.first - top) // span * span)
        for row in range(first, down.first + down.count):
            if (row - top) % span == 0:
                t = (f(row) + f(0.5) - y) - ridge
                height, rate = exp2(beside + fall * t * t), exp2(fall * (f(2) * t + f(1)))
            if row >= down.first:
                shown = np.where(height >= least, height, f(0))
                for channel, amount in enumerate(colour):
                    image[channel, row - down.first] += shown * amount
            height, rate = height * rate, rate * ratio
    return image


# Base layer


def cubic(d: float) -> float:
    """The Catmull-Rom kernel."""
    d = abs(d)
    if d <= 1:
        return (1.5 * d - 2.5) * d * d + 1.0
    return ((-0.5 * d + 2.5) * d - 4.0) * d + 2.0 if d < 2 else 0.0


def footprints(view: View, cell: int) -> list[dict[int, float]]:
    """Of each output pixel the weights of cells, which may lie outside."""
    samples = max(1, math.ceil(4 / (view.scale * cell)))
    found = []
    for pixel in range(view.count):
        weights: dict[int, float] = {}
        for sample in range(samples):
            at = view.place(pixel, (sample + 0.5) / samples) / cell - 0.5
            low = math.floor(at)
            behind = at - low + 1.5 - 0.5  # two roundings
            for tap in range(4):
                weights[low - 1 + tap] = weights.get(low - 1 + tap, 0.0) + cubic(behind - tap) / samples
        found.append(weights)
    return found


def add_base(image: F32, header: Header, model: TileModel, across: View, down: View) -> F32:
    """The image with the base layer."""
    spec = header.spec
    grid = np.asarray(model.base * (float(step_fixed(np.array(model.base_step))) * 2.0**-24))
    rows, columns = grid.shape[1:]
    horizontal = footprints(across, spec.base_cell)
    lines = np.zeros((spec.channels, rows, across.count), np.float32)
    for x, weights in enumerate(horizontal):
        for place, weight in weights.items():
            term = grid[:, :, min(max(place, 0), columns - 1)] * weight
            lines[:, :, x] = (lines[:, :, x].astype(np.float64) + term).astype(np.float32)
    for y, weights in enumerate(footprints(down, spec.base_cell)):
        for place, weight in weights.items():
            image[:, y] += lines[:, min(max(place, 0), rows - 1)] * f(weight)
    return image


# Texture


def edge(t: float, hard: bool) -> float:
    """s(t)."""
    if hard:
        return 0.0 if t < 0 else 1.0
    return 1.0 if t >= 4 else 0.0 if t <= -4 else sine_pi(0.25 + t / 16)


class Atoms:
    """Those of an axis of a tile of so many pixels, as output pixels see them; before: pixels of the first cells that
    lie before the tile.
    """

    def __init__(self, view: View, length: int, separate: bool, before: int) -> None:
        self.view, self.separate, self.begin = view, separate, -before
        self.end = float((length + before + 7) // 8 * 8 - before)
        self.sigma = math.sqrt(PIXEL_VARIANCE * max(0.0, 1 - view.scale * view.scale)) / view.scale
        self.step = min(1.0, self.sigma) if self.sigma > 0 else 1.0
        self.nodes = math.ceil(3.5 * self.sigma / self.step)

    def weight(self, offset: float) -> float:
        half = 1 / (2 * math.log(2))
        return exp2_of(-half * (offset / self.sigma) * (offset / self.sigma)) if self.sigma > 0 else 1.0

    def seen(self, middle: float, low: float, high: float) -> range:
        first, last = math.ceil((low - middle) / self.step), math.floor((high - middle) / self.step)
        return range(max(-self.nodes, first), min(self.nodes, last) + 1)

    def of(self, corner: int, side: int, pixel: int) -> F32:
        """φ_k [n] at an output pixel."""
        hard_low, hard_high = self.separate or corner == self.begin, self.separate or corner + side == self.end
        low, high = corner - (0 if hard_low else 4), min(corner + side + (0 if hard_high else 4), self.end)
        middle, sums = self.view.place(pixel, 0.5), [0.0] * side
        nodes = self.seen(middle, low, high)
        for node in nodes:
            t = middle + node * self.step - corner
            if self.separate and t >= side and corner + side != self.end:
                continue
            cosine = sine_pi(t / side, 1)
            twice = 2 * cosine
            window = edge(t, hard_low) * edge(side - t, hard_high) * self.weight(node * self.step)
            now = before = sine_pi(0.5 * t / side, 1) * window
            if self.separate:
                now, before = window, cosine * window
            for k in range(side):
                sums[k] += now
                now, before = twice * now - before, now
        if self.separate:
            sums[0] *= math.sqrt(0.5)
        total = 1.0
        if not self.view.is_plain:
            total = 0.0
            for node in self.seen(middle, self.begin, self.end):
                total += self.weight(node * self.step)
        gain = math.sqrt(2 / side) / total if len(nodes) else 0.0
        return np.array([value * gain for value in sums]).astype(np.float32)


NEXT = ((0, 1), (3, 2), (5, 4), (6, 7), (1, 0), (2, 3), (4, 5), (7, 6))


def amplitudes(texture: TextureSymbols, x: int, y: int, n: int) -> F32:
    """a [C, n, n] of a leaf."""
    steps, found = texture.steps, np.zeros((len(texture.symbols), n, n), np.float32)
    first = power_of_two(steps.step - 480)
    for c, symbols in enumerate(texture.symbols[:, y : y + n, x : x + n].tolist()):
        step = f(first if c == 0 else first * power_of_two(4 * (steps.ratios[c - 1] - 16)))
        step = step * f(power_of_two(8 * int(texture.contrast[y // 32, x // 32])))
        slope, state = f(steps.slopes[min(c, 1)]) / f(2), 0
        for diagonal in range(2 * n - 1):
            for u in range(max(0, diagonal - n + 1), min(diagonal, n - 1) + 1):
                v, symbol = diagonal - u, symbols[diagonal - u][u]
                if symbol:
                    size = f(abs(symbol)) - f(0.5 * (state % 2)) + f(steps.excess[min(abs(symbol), 3) - 1] - 8) / f(32)
                    growth = f(1) + slope * f((2 * u + 1) ** 2 + (2 * v + 1) ** 2) / f(8 * n * n)
                    found[c, v, u] = (-size if symbol < 0 else size) * step * growth
                state = NEXT[state][symbol % 2]
    (first_share, second_share), turn = steps.colours[:2], steps.colours[2]
    if (first_share, second_share, turn) == (32, 32, 8):
        return found
    cosine, sine = f(sine_pi((turn - 8) / 32, 1)), f(sine_pi((turn - 8) / 32))
    b = found[:3].copy()
    found[1] = f((first_share - 32) / 64) * b[0] + cosine * b[1] + -sine * b[2]
    found[2] = f((second_share - 32) / 64) * b[0] + sine * b[1] + cosine * b[2]
    return found


def leaves(texture: TextureSymbols) -> list[tuple[int, int, int]]:
    """(x, y, n) in the order of the stream: roots row by row, children in Z-order."""
    found = []

    def node(x: int, y: int, n: int) -> None:
        if y // 8 >= len(texture.log_size) or x // 8 >= texture.log_size.shape[1]:
            return
        if 1 << int(texture.log_size[y // 8, x // 8]) == n:
            found.append((x, y, n))
        elif n > 8:
            for child in range(4):
                node(x + child % 2 * n // 2, y + child // 2 * n // 2, n // 2)

    for y in range(0, texture.size[1] + texture.grid.top, 32):
        for x in range(0, texture.size[0] + texture.grid.left, 32):
            node(x, y, 32)
    return found


def texture_planes(header: Header, texture: TextureSymbols, across: View, down: View) -> F32:
    """What texture adds [C, h, w]."""
    channels = header.spec.channels
    planes = np.zeros((channels, down.count, across.count), np.float32)
    separate, left, top = texture.grid
    horizontal = Atoms(across, header.width, separate, left)
    vertical = Atoms(down, header.height, separate, top)

    def reached(view: View, atoms: Atoms, corner: int, side: int) -> range:
        """Output pixels that a cell may reach, and a few more."""
        spread = 4 + (atoms.nodes + 1) * atoms.step
        low = math.floor((corner - spread) * view.scale - view.offset - view.first) - 1
        high = math.ceil((corner + side + spread) * view.scale - view.offset - view.first) + 1
        return range(max(0, low), min(view.count, high))

    for x, y, n in leaves(texture):
        column, row = x - left, y - top
        columns, rows = reached(across, horizontal, column, n), reached(down, vertical, row, n)
        if not columns or not rows:
            continue
        phi_x = np.array([horizontal.of(column, n, i) for i in columns])  # [w, n]
        phi_y = np.array([vertical.of(row, n, i) for i in rows])
        given = amplitudes(texture, x, y, n)
        part = planes[:, rows.start : rows.stop, columns.start : columns.stop]
        for c in range(channels):
            lines = np.zeros((n, len(columns)), np.float32)
            for u in range(n):
                lines += given[c, :, u, None] * phi_x[None, :, u]
            for v in range(n):
                part[c] += phi_y[:, v, None] * lines[v]
    return planes


# Restoration


def restored(header: Header, model: TileModel, drawn: F32) -> F32:
    """A tile [C, h, w] at its own pixels with its correction."""
    choice = model.restoration
    assert choice is not None
    network, delta = network_of(choice.network), power_of_two(choice.step - 480)
    channels = 3 if len(drawn) >= 3 else 1
    seen = np.zeros((3, *drawn.shape[1:]), np.float32)
    seen[:channels] = drawn[:channels] * f(128 / delta)
    inputs = np.rint(np.clip(np.nan_to_num(seen), f(-32767), f(32767))).astype(np.int64)
    sums = network.sums(inputs).astype(np.float32)
    result = drawn.copy()
    result[:channels] += sums[:channels] * f(math.ldexp(delta, -network.k))
    return result


# All of it


def drawn_tile(header: Header, model: TileModel, across: View, down: View) -> F32:
    """The channels [C, h, w] of a tile; header: of the tile as a picture of its own."""
    parts = gaussians(header, model)
    if not (across.is_plain and down.is_plain):
        parts = rescaled(*parts, across, down)
    image = sum_of_gaussians(parts, across, down)
    if header.spec.base_cell:
        image = add_base(image, header, model, across, down)
    if model.texture is not None:
        image = image + texture_planes(header, model.texture, across, down)
    return image


def samples_of(header: Header, drawn: F32) -> F32:
    """I [C, h, w] of channels, not clipped."""
    spec = header.spec
    if spec.channels < 3 or not spec.plain:
        return drawn
    image, m = drawn.copy(), sample_mix(spec.luma_space)
    image[:3] = [m[c, 0] * drawn[0] + m[c, 1] * drawn[1] + m[c, 2] * drawn[2] for c in range(3)]
    return image
