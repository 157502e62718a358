"""Residual layers as docs/format.md says, sample by sample: it checks that the page says all that there is to say."""

from __future__ import annotations

import math
import struct
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from page_bits import QUICK, STEADY, BitModels, Code, coded_bits
from page_varint import decode_varint

F32 = np.float32
NEAR = ((0, -2), (0, -1), (-1, -2), (-1, -1), (-1, 0), (-1, 1), (-1, 2), (-2, -1), (-2, 0), (-2, 1))
OTHER = ((0, -1), (-1, -1), (-1, 0), (-1, 1))
CROSS = ((0, -1), (-1, 0), (0, 1), (1, 0))


@dataclass
class Grid:
    """What values of a channel stand for; most: the largest; most_off: the greatest error; table: all samples."""

    base: float
    step: float
    most: int
    most_off: int = 0
    table: list[float] = field(default_factory=list)

    def sample(self, value: int) -> np.float32:
        """What a value stands for."""
        return F32(self.table[value] if self.table else self.base + self.step * value)

    def value(self, sample: float) -> int:
        """The value of a sample."""
        if self.table:
            value = bisect_left(self.table, _rank(F32(sample)), key=lambda one: _rank(F32(one)))
            near = [other for other in (value - 1, value) if 0 <= other <= self.most]
            is_there = near[-1] == value and _rank(self.sample(value)) == _rank(F32(sample))
            return value if is_there else min(near, key=lambda other: abs(self.table[other] - sample))
        return min(self.most, max(0, math.floor((sample - self.base) / self.step + 0.5)))


def block(
    drawn: NDArray[np.float32],
    order: list[int],
    grids: list[Grid],
    has_bits: bool,
    nodata: list[float | None],
    code: Code,
    palette: list[list[int]] | None = None,
    has_cells: bool = False,
) -> NDArray[np.float32]:
    """Samples [h, w, C] of a block. order: channels as they are coded; nodata: that of each channel; palette: values of
    each colour; has_cells: whether not all cells are coded.
    """
    height, width, _ = drawn.shape
    outside = _outside(height, width, code) if has_cells else np.zeros((height, width, 1), bool)
    if palette:
        nothing, numbers = np.zeros((height, width, 1), F32), [Grid(0, 1, len(palette) - 1)]
        number = _coded(nothing, outside, [0], numbers, False, [None], code)[..., 0].astype(int)
        colours = [[grid.sample(value) for grid, value in zip(grids, colour, strict=True)] for colour in palette]
        return np.where(outside, drawn, np.array(colours)[number].astype(F32))
    return _coded(drawn, outside, order, grids, has_bits, nodata, code)


def grid_of(form: bytes, at: int, is_whole: bool) -> tuple[Grid, int]:
    """A grid that is stated at a place, and where it ends. is_whole: whether samples are whole numbers."""
    base: float
    step: float
    if is_whole:
        base, at = decode_varint(form, at)
        step, at = decode_varint(form, at)
    else:
        (base, step), at = struct.unpack_from("<2d", form, at), at + 16
    most, at = decode_varint(form, at)
    max_error, at = decode_varint(form, at)
    count, at = decode_varint(form, at)
    grid, code = Grid(base, step, most, max_error), coded_bits(form[at : at + count])
    if count:
        grid.table = _whole_numbers(grid, code) if is_whole else _floats(grid, code)
        grid.most = len(grid.table) - 1
    return grid, at + count


def _whole_numbers(grid: Grid, code: Code) -> list[float]:
    models, found, since = BitModels(), [], 0
    for value in range(grid.most + 1):
        if models.bit(code, STEADY, min(63, since)):
            found.append(float(grid.sample(value)))
            since = -1
        since += 1
    return found


def _floats(grid: Grid, code: Code) -> list[float]:
    distances, found = _Distances(), [grid.base]
    for j in range(grid.most + 1):
        far = 0 if j == 0 else grid.step if j == 1 else found[-1] - found[-2]
        found.append(float(_of_rank(_rank(F32(found[-1] + far)) + distances.next(code))))
    return found[1:]


def _outside(height: int, width: int, code: Code) -> NDArray[np.bool_]:
    cells = np.zeros((-(-height // 16) + 1, -(-width // 16) + 2), int)  # with those above, left and right of all
    models = BitModels()
    for y in range(1, cells.shape[0]):
        for x in range(1, cells.shape[1] - 1):
            context = cells[y, x - 1] + 2 * cells[y - 1, x] + 4 * cells[y - 1, x + 1]
            cells[y, x] = models.bit(code, QUICK, context)
    return np.kron(cells[1:, 1:-1], np.ones((16, 16), int))[:height, :width, None] == 0


def _coded(
    drawn: NDArray[np.float32],
    outside: NDArray[np.bool_],
    order: list[int],
    grids: list[Grid],
    has_bits: bool,
    nodata: list[float | None],
    code: Code,
) -> NDArray[np.float32]:
    height, width, count = drawn.shape
    held = ~np.isfinite(drawn)
    for c in range(count):
        held[..., c] |= drawn[..., c] == nodata[c] if nodata[c] is not None else False
    shown = np.stack([_on_grid(drawn[..., c], held[..., c], grids[c]) for c in range(count)], axis=2)
    held |= outside
    values = np.zeros((height, width, count), int)
    channels = [_Channel(k, shown[..., c], 2 * grids[c].most_off + 1, grids[c].most) for k, c in enumerate(order)]
    models = [BitModels() for _ in range(min(3, len(order)))]
    repeats, solved = _Repeats(width, height), False
    is_exact = not any(grid.most_off for grid in grids)
    for y in range(height):
        for x in range(width):
            solved = x % 32 > 0 and solved
            found = repeats.code(y, x, not held[y, x].any(), code) if is_exact else None
            if found is None and not solved:
                solved = True
                for each in channels:
                    each.solve(x // 32, y)
            for channel in channels:
                channel.prepare(channels, y, x)
            for k, channel in enumerate(channels):
                c = order[k]
                if held[y, x, c]:
                    values[y, x, c] = channel.d(y, x)
                    channel.note(y, x, 0, channel.d(y, x), 64, (0, 0))
                elif found is not None and not solved:
                    values[y, x, c] = values[found // width, found % width, c]
                    channel.note(y, x, values[y, x, c] - channel.d(y, x), values[y, x, c], 0, (0, 0))
                else:
                    known = None if found is None else int(values[found // width, found % width, c])
                    values[y, x, c] = channel.sample(channels, y, x, known, models[min(k, 2)], code)
            if is_exact:
                repeats.learn(y, x, values[y, x].tolist())
        for channel in channels:
            channel.sums *= F32(0.9)
    out = drawn.copy()
    distances = [_Distances() for _ in range(count)]
    for y, x, c in zip(*np.nonzero(~held), strict=True):
        grid, value = grids[c], int(values[y, x, c])
        if grid.most_off and grid.sample(value) == nodata[c]:
            value += 1 if value == 0 else -1 if value == grid.most else 2 * code(32768) - 1
        found = grid.sample(min(grid.most, value))
        out[y, x, c] = _of_rank(_rank(found) + distances[c].next(code)) if has_bits else found
    return out


def _on_grid(drawn: NDArray[np.float32], held: NDArray[np.bool_], grid: Grid) -> NDArray[np.int_]:
    out = np.zeros(drawn.shape, int)
    for y, x in np.ndindex(*drawn.shape):
        if not held[y, x]:
            out[y, x] = grid.value(float(drawn[y, x]))
        elif x or y:
            out[y, x] = out[y, x - 1] if x else out[y - 1, 0]
    return out


def _rank(sample: np.float32) -> int:
    bits = int(sample.view(np.int32))
    return bits if bits >= 0 else -(bits & 0x7FFFFFFF) - 1


def _of_rank(rank: int) -> np.float32:
    return np.uint32(rank if rank >= 0 else (-rank - 1) | 0x80000000).view(np.float32)


class _Distances:
    def __init__(self) -> None:
        self.models = BitModels()
        self.length = 0

    def next(self, code: Code) -> int:
        length, more = 0, 1
        while length < 33 and more:
            more = self.models.bit(code, STEADY, (self.length, length))
            length += more
        self.length = length
        if not length:
            return 0
        sign, distance = 1 - 2 * code(32768), 1
        for _ in range(length - 1):
            distance = 2 * distance + code(32768)
        return sign * distance


class _Repeats:
    def __init__(self, width: int, height: int) -> None:
        self.width = width
        self.colours = np.zeros((height + 2, width + 4), np.int64)
        self.hits = np.zeros((height + 2, width + 4), int)
        self.far: dict[int, _Seen] = {}
        self.near: dict[int, _Seen] = {}
        self.models, self.chances = BitModels(), BitModels()

    def code(self, y: int, x: int, is_coded: bool, code: Code) -> int | None:
        """The number of the pixel that this one repeats."""
        colours = self.colours[y : y + 3, x : x + 5].tolist()
        (_, (nww, nw, n, ne, nee), (ww, w, *_)), (nn2w, nnw, nn, nne, nn2e) = colours, colours[0]
        near = _mixed([w, n, ne, nw, ww, nn], 0)
        far = _mixed([nee, nww, nnw, nne, nn2w, nn2e], near)
        equal = [w == n, w == nw, n == ne, n == nw, w == ww, n == nn]
        alike = sum(1 << i for i, one in enumerate(equal) if one)
        self.places = [self.far.setdefault(far >> 16, _Seen()), self.near.setdefault(near >> 16, _Seen())]
        is_graphic = self.chances.p("all") > 30000
        if not is_graphic:
            self.places = []
        seen = [(place.last, place.before, min(7, place.times)) for place in self.places] or [(None, None, 0)] * 2
        times = [one[2] for one in seen]
        number = y * self.width + x
        sources = [seen[0][0], seen[1][0], (number - 1, w) if x else None, seen[1][1]]
        sources += [(number - self.width, n) if y else None]
        sources += [(number - self.width + 1, ne) if y and x < self.width - 1 else None]
        found: list[tuple[int, int, int]] = []
        for source, pixel in enumerate(sources):
            if pixel is not None and len(found) < 5 and pixel[1] not in [colour for _, colour, _ in found]:
                found.append((*pixel, source))
        self.is_odd = not is_graphic and alike == 0
        self.hit, self.candidates = 0, found if is_coded and not self.is_odd else []
        if not self.candidates:
            return None
        self.chance = (found[0][2], 8 * times[0] + times[1], alike)
        if self.chances.p(self.chance) <= (2000 if is_graphic else 40000):
            return None
        digits = [self.hits[y + 2, x + 1], self.hits[y + 1, x + 2], self.hits[y + 1, x + 3], self.hits[y + 1, x + 1]]
        hits = int("".join(map(str, digits)), 7)
        for r, (place, _, source) in enumerate(found):
            numbers = [
                64 * (6 * r + source) + 8 * times[0] + times[1],
                1920 + 64 * r + alike,
                2240 + (_mixed([r], near) >> 17),
                35008 + 2401 * r + hits,
                47013 + 64 * (6 * r + source) + alike,
            ]
            self.hit = r + 1
            if self.models.bit(code, QUICK, *numbers):
                return place
        self.hit = 6
        return None

    def learn(self, y: int, x: int, samples: list[int]) -> None:
        colour = 1
        for sample in samples:
            colour = (colour ^ sample) * 0x01000193 & 0xFFFFFFFF
        first, last = 0 if x == 0 else x + 2, x + 5 if x == self.width - 1 else x + 3
        self.colours[y + 2, first:last], self.hits[y + 2, first:last] = colour, self.hit
        if self.candidates:
            is_hit = colour in [one for _, one, _ in self.candidates]
            self.chances.learn(is_hit, STEADY, self.chance)
            self.chances.learn(is_hit, STEADY, "all")
        elif self.is_odd:
            self.chances.learn(0, STEADY, "all")
        for place in self.places:
            if place.last is not None and place.last[1] == colour:
                place.times = min(8, place.times + 1)
            else:
                place.before, place.times = place.last, 1
            place.last = (y * self.width + x, colour)


class _Seen:
    def __init__(self) -> None:
        self.last: tuple[int, int] | None = None
        self.before: tuple[int, int] | None = None
        self.times = 0


def _mixed(colours: list[int], found: int) -> int:
    for colour in colours:
        found = (found ^ colour) * 0x9E3779B1 & 0xFFFFFFFF
        found ^= found >> 15
    return found


class _Channel:
    def __init__(self, k: int, drawn: NDArray[np.int_], step: int, largest: int) -> None:
        self.k, self.drawn, self.step, self.largest = k, drawn, step, largest
        height, width = drawn.shape
        self.n = 15 + 5 * min(k, 2) + 4 * (k > 0)
        self.prior = np.zeros(self.n)
        self.prior[[1, 3, 4, 5]] = 0.4, -0.15, 0.45, 0.1
        if k:
            self.prior[-1] = 0.8
        self.sums = np.zeros(((width + 31) // 32, self.n + 1, self.n + 1), F32)
        self.weights = [self.prior.astype(F32)] * len(self.sums)
        self.found_in = [-2] * len(self.sums)
        self.e = np.zeros((height + 2, width + 4), int)
        self.magnitude = np.full((height + 2, width + 4), 64)
        self.value = np.zeros((height + 2, width + 4), int)
        self.misses = np.zeros((2, height + 2, width + 4), int)

    def solve(self, segment: int, row: int) -> None:
        last, n = len(self.sums) - 1, self.n
        self.segment = segment
        if self.found_in[segment] == row - 1:
            return
        self.found_in[segment] = row
        own, left, right = (self.sums[min(last, max(0, s))].astype(float) for s in (segment, segment - 1, segment + 1))
        total = own + 0.6 * (left + right)
        matrix, shares, weights = total.copy(), np.zeros((n, n + 1)), np.zeros(n)
        for i in range(n):
            matrix[i, i] += 4
            matrix[i, n] += 4 * self.prior[i]
        for k in range(n):
            inverse = 1 / matrix[k, k] if matrix[k, k] > 1e-6 * (total[k, k] + 4) else 0
            shares[k, k + 1 :] = matrix[k, k + 1 :] * inverse
            for i in range(k + 1, n):
                matrix[i, i:] -= shares[k, i] * matrix[k, i:]
        for i in range(n - 1, -1, -1):
            weights[i] = shares[i, n]
            shares[:i, n] -= shares[:i, i] * weights[i]
        self.weights[segment] = weights.astype(F32)

    def d(self, y: int, x: int) -> int:
        height, width = self.drawn.shape
        return int(self.drawn[min(height - 1, max(0, y)), min(width - 1, max(0, x))])

    def cross(self, y: int, x: int) -> list[int]:
        return [self.d(y + down, x + across) - self.d(y, x) for down, across in CROSS]

    def prepare(self, channels: list[_Channel], y: int, x: int) -> None:
        k, v, j = self.k, y + 2, x + 2
        self.inputs = [self.e[v + down, j + across] for down, across in NEAR] + self.cross(y, x)
        for other in channels[max(0, k - 2) : k]:
            self.inputs += [other.e[v + down, j + across] for down, across in OTHER]
        self.inputs += channels[k - 1].cross(y, x) if k else []
        left, above, corner = (int(self.value[v + down, j + across]) for down, across in ((0, -1), (-1, 0), (-1, -1)))
        plane = min(max(left + above - corner, min(left, above)), max(left, above))
        self.inputs.append(plane - self.d(y, x))

    def sample(self, channels: list[_Channel], y: int, x: int, known: int | None, models: BitModels, code: Code) -> int:
        k, v, j = self.k, y + 2, x + 2
        drawn, inputs = self.d(y, x), [*self.inputs, *(other.e[v, j] for other in channels[max(0, k - 2) : k])]
        products, early = self.weights[self.segment] * np.array(inputs, F32), len(self.inputs)
        sums = np.append(products[:early], np.zeros(32 - early, F32))
        while len(sums) > 1:
            sums = sums[: len(sums) // 2] + sums[len(sums) // 2 :]
        for product in products[early:]:
            sums = sums + product
        p = math.floor(16 * min(float(self.largest), max(0.0, drawn + float(sums[0]))) + 0.5)
        middle = (p + 8) >> 4
        f = p - 16 * middle
        guesses = self.guesses(channels, v, j)
        spread, numbers = self.context(channels, v, j, middle)
        for i, (guess, kind) in enumerate(guesses):
            place = min(6, max(-6, self.steps(guess - middle))) + 6
            numbers.append((2176, 3424)[i] + ((place * 4 + kind) * 12 + self.doubt(i, v, j)) * 2 + (f >= 0))

        def coded(node: int) -> int:
            return models.bit(code, STEADY, *(16 * number + node for number in numbers))

        def digit(*context: int) -> int:
            return models.bit(code, STEADY, context) if context else code(32768)

        found = self.steps_coded(coded, digit, middle, f, spread) if known is None else known
        self.learn([*inputs, found - drawn], spread)
        misses = [min(6, abs(self.steps(found - guess))) for guess, _ in guesses]
        self.note(y, x, found - drawn, found, abs(16 * found - p) // self.step, (misses[0], misses[1]))
        return found

    def steps_coded(
        self, coded: Callable[[int], int], digit: Callable[..., int], middle: int, f: int, spread: int
    ) -> int:
        most_off = (self.step - 1) // 2
        low, high = -((middle + most_off) // self.step), (self.largest - middle + most_off) // self.step
        if f >= 0:
            up = coded(0) if high >= 1 else 0
            start = 1 if up else 0
        else:
            up = coded(0) if low <= -1 else 1
            start = 0 if up else -1
        distance = _distance(coded, digit, spread, up, high - start if up else start - low)
        steps = start + distance if up else start - distance
        return min(self.largest, max(0, middle + self.step * steps))

    def note(self, y: int, x: int, e: int, value: int, magnitude: int, misses: tuple[int, int]) -> None:
        v, j = y + 2, x + 2
        for column in range(0 if x == 0 else j, (j + 3) if x == self.drawn.shape[1] - 1 else j + 1):
            self.e[v, column], self.value[v, column], self.magnitude[v, column] = e, value, magnitude
            self.misses[:, v, column] = misses

    def learn(self, values: list[int], spread: int) -> None:
        s = F32(spread)
        weight = F32(1) / (F32(1) + s * s * (F32(0.6) / F32(256)))
        v = np.array(values, F32)
        self.sums[self.segment] += (v * weight)[:, None] * v[None, :]

    def steps(self, off: int) -> int:
        return (abs(off) + (self.step - 1) // 2) // self.step * (1 if off >= 0 else -1)

    def guesses(self, channels: list[_Channel], v: int, j: int) -> list[tuple[int, int]]:
        def values(channel: _Channel) -> list[int]:
            return [int(channel.value[v + a, j + b]) for a, b in ((0, 0), (0, -1), (-1, 0), (-1, -1))]

        _, left, above, corner = values(self)
        if self.k == 0:
            copied = (above, 1) if left == corner else (left, 2) if above == corner else (left, 0)
            return [copied, (above, 0 if above == copied[0] else 3)]
        here, there, up, _ = values(channels[self.k - 1])
        copied = (above, 1) if here == up else (left, 2) if here == there else (left + here - there, 3)
        first, _, first_above, _ = values(channels[0])
        moved = above + first - first_above
        return [copied, (moved, 1 if moved == copied[0] else 2)]

    def doubt(self, i: int, v: int, j: int) -> int:
        m = self.misses[i]
        near, far = int(m[v, j - 1] + m[v - 1, j]), int(m[v, j - 2] + m[v - 2, j])
        return (near if near < 3 else 3 if near < 6 else 4 if near < 9 else 5) + (6 if far > 2 else 0)

    def context(self, channels: list[_Channel], v: int, j: int, middle: int) -> tuple[int, list[int]]:
        k, m = self.k, self.magnitude
        left, above, la, ra = (int(m[v + a, j + b]) for a, b in ((0, -1), (-1, 0), (-1, -1), (-1, 1)))
        near = (4 * left + 4 * above + 2 * la + 2 * ra + int(m[v, j - 2]) + int(m[v - 2, j])) // 14
        b = int(channels[k - 1].magnitude[v, j]) if k else 0
        c = int(channels[k - 2].magnitude[v, j]) if k > 1 else b
        s = near if k == 0 else (10 * near + 3 * b + 3 * c) // 16
        s5 = _size(s, 1, 32)
        return s, [
            (s5 * 8 + _size(b // 4, 0, 8)) * 8 + _size(c // 4, 0, 8),
            2048 + 8 * (middle >> max(0, self.largest.bit_length() - 4)) + min(7, s5 // 2),
        ]


def _size(value: int, part: int, classes: int) -> int:
    u = value + 1
    log = u.bit_length() - 1
    rest = (u >> (log - part) if log >= part else u << (part - log)) & ((1 << part) - 1)
    return min(classes - 1, (log << part) + rest)


def _distance(coded: Callable[[int], int], digit: Callable[..., int], spread: int, up: int, most: int) -> int:
    size = 0 if spread < 32 else (spread >> 4).bit_length() - 2
    start = runs = rest = 0
    while start + (1 << size) <= most and coded((8 if up else 1) + min(runs, 6)):
        start += 1 << size
        runs += 1
        size += runs >= 4
    for depth in range(size):
        known = (up, min(size, 11), min(runs, 3), depth, rest) if depth < 3 else ()
        rest = 2 * rest + digit(*known)
    return start + rest
