"""Butteraugli's 3-norm of a decoded picture against an original, with gradients.

    reference = Reference(original)  # [3, H, W], sRGB samples in 0..1
    reference.norm(decoded).backward()

It agrees with the 3-norm that `butteraugli_main` of libjxl 0.7 prints.

Source: libjxl 0.7, lib/jxl/butteraugli/butteraugli.cc, whose constants these are and whose stages have their names
here: opsin, frequency bands (lf, mf, hf, uhf), Malta, mask.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

__all__ = ["Reference"]

INTENSITY = 80.0
"""Nits of white."""
ASYMMETRY = 0.8
"""How much less it counts that something is added at high frequencies than that it is lost."""
SCALE = 1 / (17.8 * math.log(80.0) / math.log(255.0))
"""Of all differences."""
LEAST_SIDE = 15
"""Pixels of the sides from which on a picture is compared at half its size, too."""

MIX = (
    (0.29956550340058319, 0.63373087833825936, 0.077705617820981968),
    (0.22158691104574774, 0.69391388044116142, 0.0987313588422),
    (0.02, 0.02, 0.20480129041026129),
)
BIAS = (1.7557483643287353, 1.7557483643287353, 12.226454707163354)
"""What cones give of linear light, and what each gives at least."""

Line = tuple[tuple[int, int], ...]
FINE: tuple[Line, ...] = (
    ((0, 1), (0, 2), (0, 3), (0, 4)), ((1, 0), (2, 0), (3, 0), (4, 0)),
    ((1, 1), (2, 2), (3, 3)), ((1, -1), (2, -2), (3, -3)),
    ((1, 0), (2, -1), (3, -1), (4, -1)), ((1, 0), (2, 1), (3, 1), (4, 1)),
    ((0, 1), (1, 2), (1, 3), (1, 4)), ((0, 1), (-1, 2), (-1, 3), (-1, 4)),
    ((1, 1), (2, 1), (3, 2)), ((1, -1), (2, -1), (3, -2)),
    ((1, 1), (1, 2), (2, 3)), ((1, -1), (1, -2), (2, -3)),
)  # fmt: skip
COARSE: tuple[Line, ...] = (
    ((0, 2), (0, 4)), ((2, 0), (4, 0)), ((2, 2), (3, 3)), ((2, -2), (3, -3)),
    ((2, -1), (4, -1)), ((2, 1), (4, 1)), ((1, 2), (1, 4)), ((-1, 2), (-1, 4)),
    ((2, 1), (3, 2)), ((2, -1), (3, -2)), ((1, 2), (2, 3)), ((1, -2), (2, -3)),
    ((1, -2), (2, -4)), ((1, 2), (2, 4)), ((2, 1), (4, 2)), ((2, -1), (4, -2)),
)  # fmt: skip
"""Malta's lines: rows and columns from the centre, to one side; the other mirrors it."""
FINE_WEIGHTS = (1.0,) * 4 + (2.0,) * 4 + (1.0,) * 4

UHF_MALTA = ((173.5, 5.0), (1.10039032555, 71.7800275169))
HF_MALTA = ((6923.99476109, 8051.15833247), (18.7237414387, 4498534.45232))
MF_MALTA = ((8246.75321353, 1009002.70582), (37.0819870399, 130262059.556))
"""Weight and norm of the first two channels."""
HF_WEIGHTS, MF_WEIGHTS = (400.0, 1.50815703118), (2150.0, 10.6195433239, 16.2176043152)
LF_WEIGHTS = (29.2353797994, 0.844626970982, 0.703646627719)
"""Of squared differences of channels."""


class Bands(NamedTuple):
    """A picture's frequencies: lf, mf [3, H, W], hf, uhf [2, H, W]."""

    lf: Tensor
    mf: Tensor
    hf: Tensor
    uhf: Tensor


class Reference:
    """An original [3, H, W], sRGB samples in 0..1, that decoded pictures of this shape are compared with."""

    def __init__(self, original: Tensor) -> None:
        with torch.no_grad():
            light = _linear(original)
            self._full = _Level.of(light)
            self._half = _Level.of(_halved(light)) if min(light.shape[1:]) >= LEAST_SIDE else None

    def norm(self, decoded: Tensor) -> Tensor:
        """The mean of the 3-, 6- and 12-norm of the differences: a scalar, nearly 0 for equal pictures."""
        differences = self.differences(decoded)
        most = differences.detach().amax().clamp(min=1e-6)
        cubes = (differences / most) ** 3
        norms = [(cubes**power).mean() ** (1 / (3 * power)) for power in (1, 2, 4)]
        return most * torch.stack(norms).mean()

    def differences(self, decoded: Tensor) -> Tensor:
        """How much each pixel [H, W] differs."""
        light = _linear(decoded)
        full = self._full.differences(light)
        if self._half is None:
            return full
        half = self._half.differences(_halved(light)).repeat_interleave(2, 0).repeat_interleave(2, 1)
        return 0.85 * full + 0.5 * half[: full.shape[0], : full.shape[1]]


@dataclass(frozen=True)
class _Level:
    """The original at one size. mask [H, W]: how much is there that hides differences; ac, dc [H, W]: what differences
    of details and of the lowest frequencies count.
    """

    bands: Bands
    mask: Tensor
    ac: Tensor
    dc: Tensor

    @classmethod
    def of(cls, light: Tensor) -> _Level:
        bands = _bands(_opsin(light))
        mask = _mask(bands)
        eroded = _eroded(mask)
        ac = SCALE * (1 + 2.5485944793 / (0.451936922203 * eroded + 0.829591754942))
        dc = SCALE * (1 + 0.505054525019 / (3.87449418804 * eroded + 0.20025578522))
        return cls(bands, mask, ac**2, dc**2)

    def differences(self, light: Tensor) -> Tensor:
        seen, own = _bands(_opsin(light)), self.bands
        fine = _Lines(FINE, FINE_WEIGHTS, 0.39905817637)
        coarse = _Lines(COARSE, (1.0,) * len(COARSE), 0.611612573796)
        ac = 10.0 * (self.mask - _mask(seen)) ** 2
        for c in range(2):
            ac = ac + fine.difference(own.uhf[c], seen.uhf[c], *UHF_MALTA[c], ASYMMETRY)
            ac = ac + coarse.difference(own.hf[c], seen.hf[c], *HF_MALTA[c], ASYMMETRY**0.5)
            ac = ac + coarse.difference(own.mf[c], seen.mf[c], *MF_MALTA[c], 1.0)
            weight = 0.8 * HF_WEIGHTS[c]
            ac = ac + weight * ASYMMETRY * (seen.hf[c] - own.hf[c]) ** 2
            ac = ac + weight / ASYMMETRY * _outside(own.hf[c], seen.hf[c], 0.4, 1.0) ** 2
        ac = ac + _weighted(MF_WEIGHTS, (seen.mf - own.mf) ** 2)
        dc = _weighted(LF_WEIGHTS, (seen.lf - own.lf) ** 2)
        return torch.sqrt((dc * self.dc + ac * self.ac).clamp(min=1e-12))


class _Lines:
    """Malta: differences that lie along lines count more than scattered ones."""

    def __init__(self, lines: tuple[Line, ...], weights: tuple[float, ...], factor: float) -> None:
        self._kernels = torch.zeros(len(lines), 1, 9, 9)
        self._factor = factor / 8.5
        for kernel, line, weight in zip(self._kernels[:, 0], lines, weights, strict=True):
            for y, x in ((0, 0), *line):
                kernel[4 + y, 4 + x] = kernel[4 - y, 4 - x] = weight**0.5

    def difference(self, own: Tensor, seen: Tensor, weight: float, norm: float, asymmetry: float) -> Tensor:
        """Of one channel [H, W] of an original and a decoded picture."""
        both, lost = (self._factor * norm * (share * weight) ** 0.5 for share in (0.5 * asymmetry, 0.33 / asymmetry))
        moved = both * (own - seen) + lost * _outside(own, seen, 0.55, 1.05)
        moved = moved / (norm + 0.5 * (own.abs() + seen.abs()))
        return F.conv2d(moved[None, None], self._kernels.to(own), padding=4).square().sum(dim=(0, 1))


def _weighted(weights: tuple[float, ...], planes: Tensor) -> Tensor:
    """The sum of planes [C, H, W], each times its weight."""
    return (planes.new_tensor(weights)[:, None, None] * planes).sum(dim=0)


def _outside(own: Tensor, seen: Tensor, least: float, most: float) -> Tensor:
    """How far what is seen lies outside `least` to `most` times the original."""
    low, high = torch.aminmax(torch.stack([least * own, most * own]), dim=0)
    return torch.minimum(torch.maximum(seen, low), high) - seen


def _linear(samples: Tensor) -> Tensor:
    """Light of sRGB samples."""
    power: Tensor = ((samples.clamp(min=0.04) + 0.055) / 1.055) ** 2.4
    return torch.where(samples <= 0.04045, samples / 12.92, power)


def _halved(planes: Tensor) -> Tensor:
    height, width = planes.shape[1:]
    even = F.pad(planes[None], (0, width % 2, 0, height % 2), mode="replicate")
    return F.avg_pool2d(even, 2)[0]


def _convolved(planes: Tensor, kernel: Tensor) -> Tensor:
    """Planes [..., H, W] without the borders that a kernel [k] takes off."""
    flat = planes.reshape(-1, 1, *planes.shape[-2:])
    flat = F.conv2d(F.conv2d(flat, kernel.view(1, 1, -1, 1)), kernel.view(1, 1, 1, -1))
    return flat.view(*planes.shape[:-2], *flat.shape[-2:])


def _kernel(sigma: float, like: Tensor) -> Tensor:
    radius = max(1, int(2.25 * sigma))
    kernel = torch.exp(-(torch.arange(-radius, radius + 1, dtype=torch.float64) ** 2) / (2 * sigma**2))
    return (kernel / kernel.sum()).to(like)


def _blurred(planes: Tensor, sigma: float) -> Tensor:
    """Of what lies inside the picture alone."""
    kernel = _kernel(sigma, planes)
    radius = len(kernel) // 2
    shares = [
        F.conv1d(planes.new_ones(1, 1, side), kernel.view(1, 1, -1), padding=radius).view(-1)
        for side in planes.shape[-2:]
    ]
    return _convolved(F.pad(planes, (radius,) * 4), kernel) / (shares[0][:, None] * shares[1])


def _opsin(light: Tensor) -> Tensor:
    """What the eye sees of light [3, H, W]: red against green, their sum, and blue."""
    rows, columns = (torch.tensor([1, 0, *range(side), side - 1, side - 2]) for side in light.shape[1:])
    around = _convolved(light[:, rows][:, :, columns], _kernel(1.2, light))
    mix, bias = INTENSITY * light.new_tensor(MIX), light.new_tensor(BIAS)[:, None, None]
    cones = [torch.tensordot(mix, planes, 1) + bias for planes in (light, around)]
    adapted = torch.maximum(cones[1], bias)
    gain = (19.245013259874995 * torch.log(adapted + 9.9710635769299145) - 23.16046239805755) / adapted
    red, green, blue = torch.maximum(cones[0] * gain.clamp(min=1e-4), bias)
    return torch.stack([red - green, red + green, blue])


def _bands(opsin: Tensor) -> Bands:
    low = _blurred(opsin, 7.15593339443)
    middle = _blurred(opsin - low, 3.22489901262)
    x, y, b = low
    lf = torch.stack([32.22174835205078 * x, 13.769779205322266 * y, 47.504615783691406 * (b - 0.362267051518 * y)])
    mf = torch.stack([F.softshrink(middle[0], 0.29), _amplified(middle[1], 0.1), middle[2]])
    x, y = (opsin - low - middle)[:2]
    suppressed = 0.653020556257
    x = x * (suppressed + 46.0 * (1 - suppressed) / (y * y + 46.0))
    high_x, high_y = _blurred(torch.stack([x, y]), 1.56416327805)
    hf_y = _compressed(high_y, 28.4691806922)
    uhf = torch.stack([F.softshrink(x - high_x, 0.04), 2.69313763794 * _compressed(y - hf_y, 5.19175294647)])
    return Bands(lf, mf, torch.stack([F.softshrink(high_x, 1.5), _amplified(2.155 * hf_y, 0.132)]), uhf)


def _amplified(plane: Tensor, most: float) -> Tensor:
    return plane + plane.clamp(-most, most)


def _compressed(plane: Tensor, most: float) -> Tensor:
    slope = 0.724216145665
    return slope * plane + (1 - slope) * plane.clamp(-most, most)


def _mask(bands: Bands) -> Tensor:
    """How much each place [H, W] hides."""
    x, y = bands.hf + bands.uhf
    activity = torch.sqrt(((2.5 * x) ** 2 + (0.4 * y) ** 2).clamp(min=1e-16))
    factor = 6.19424080439
    bias = 12.61050594197 * factor
    return _blurred(torch.sqrt(factor * activity + bias) - bias**0.5, 2.7)


def _eroded(mask: Tensor) -> Tensor:
    """The mean of the three least values of nine, three pixels apart; outside the picture is none."""
    height, width = mask.shape
    padded = F.pad(mask, (3, 3, 3, 3), value=math.inf)
    least = [mask, 2 * mask, 2 * mask]
    for y, x in ((y, x) for y in (0, 3, 6) for x in (0, 3, 6) if (y, x) != (3, 3)):
        value = padded[y : y + height, x : x + width]
        for i, other in enumerate(least):
            least[i], value = torch.minimum(other, value), torch.maximum(other, value)
    return 0.45 * least[0] + 0.3 * least[1] + 0.25 * least[2]
