"""What a stream may be asked to end at: the table of targets, and how far a measured stream is from one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

QuantityName = Literal["bytes", "psnr", "score"]
"""Bytes of a stream on disk, the PSNR in dB or the SSIMULACRA 2 score of its decoded samples."""

_SIZE_MIN_FRACTION = 0.97
"""Least part of the size that was asked for."""
_SIZE_AIM_FRACTION = 0.985
"""Part of the size at which the rate error is zero: in the middle of what is allowed."""
_PSNR_TOLERANCE_DB = 0.1
"""How far a PSNR may lie from the one that was asked for."""
_SIZE_OCTAVES_PER_LMBDA_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
_PSNR_DB_PER_LMBDA_OCTAVE = 1.5
_SCORE_TOLERANCE = 1.0
"""How far a SSIMULACRA 2 score may lie from the one that was asked for."""
_SCORE_PER_LMBDA_OCTAVE = 8.0
"""Of photographs between scores of 40 and 80; below, an octave takes more."""
_PSNR_MAX_DB = 200.0
"""Stands for the infinite PSNR of a picture without error."""


@dataclass(frozen=True)
class _Quantity:
    """What of a stream a target is about."""

    per_octave: float
    """How much of it, or how many octaves of bytes, an octave of λ takes or gives."""
    near: Callable[[float], tuple[float, float]]
    """The least and the largest value that meets a target."""
    asked: str
    """How a message names a target."""
    reached: str
    """How it names what the best stream has."""
    is_size: bool = False
    """Whether it is bytes, of which there may be no more, rather than a quality, which may not be less."""
    largest: float = math.inf
    """Stands for all above."""


_QUANTITIES: dict[QuantityName, _Quantity] = {
    "bytes": _Quantity(
        _SIZE_OCTAVES_PER_LMBDA_OCTAVE,
        near=lambda wanted: (_SIZE_MIN_FRACTION * wanted, wanted),
        asked="at most {:.0f} bytes",
        reached="smallest has {:.0f}",
        is_size=True,
    ),
    "psnr": _Quantity(
        _PSNR_DB_PER_LMBDA_OCTAVE,
        near=lambda wanted: (wanted - _PSNR_TOLERANCE_DB, wanted + _PSNR_TOLERANCE_DB),
        asked="{:g} dB",
        reached="best reaches {:.2f} dB",
        largest=_PSNR_MAX_DB,
    ),
    "score": _Quantity(
        _SCORE_PER_LMBDA_OCTAVE,
        near=lambda wanted: (wanted - _SCORE_TOLERANCE, wanted + _SCORE_TOLERANCE),
        asked="SSIMULACRA 2 {:g}",
        reached="best reaches {:.1f}",
    ),
}


@dataclass(frozen=True)
class RateTarget:
    """A size in bytes that the stream must not exceed, or a PSNR in dB or a SSIMULACRA 2 score that it must have; what
    is `measured` of a stream is the same quantity.
    """

    quantity: QuantityName
    wanted: float

    @property
    def _quantity(self) -> _Quantity:
        return _QUANTITIES[self.quantity]

    def rate_error(self, measured: float) -> float:
        """Estimate of the octaves by which λ should rise: positive where the stream spends more than was asked for."""
        quantity = self._quantity
        if quantity.is_size:
            return math.log2(max(measured, 1.0) / (_SIZE_AIM_FRACTION * self.wanted)) / quantity.per_octave
        return float(min(measured, quantity.largest) - self.wanted) / quantity.per_octave

    def is_met(self, measured: float) -> bool:
        """Size: at most the target, and within 3 % of it. PSNR: within 0.1 dB. Score: within 1."""
        low, high = self._quantity.near(self.wanted)
        return low <= measured <= high

    def is_missed(self, measured: float) -> bool:
        """Whether the stream is larger than was allowed, or worse than was asked for."""
        low, high = self._quantity.near(self.wanted)
        return measured > high if self._quantity.is_size else measured < low

    def nearest(self, streams: Sequence[float]) -> int:
        """Index of the stream with the least rate error, among those that do not miss the target if there are any."""
        sound = [index for index, measured in enumerate(streams) if not self.is_missed(measured)]
        return min(sound or range(len(streams)), key=lambda index: abs(self.rate_error(streams[index])))

    def miss_message(self, measured: float) -> str:
        """What to report where the best stream misses the target."""
        asked, reached = self._quantity.asked.format(self.wanted), self._quantity.reached.format(measured)
        return f"no stream of {asked} was found; the {reached}"


@dataclass(frozen=True)
class Target:
    """A setting that names a rate target, and an option of the command line of the same name."""

    quantity: QuantityName
    """What of a stream it is about."""
    is_sound: Callable[[float], bool]
    """Which values make sense."""
    rule: str
    """What a message says of the others."""
    metavar: str
    """What help shows for a value."""
    noun: str
    """What a message calls a value."""
    example: str
    """A value, or several."""
    help: str
    """What help says."""
    per_pixel: bool = False
    """Whether values are bits for each pixel."""
    tune: Literal["psnr", "visual"] = "visual"
    """What an encode is tuned for that does not say so."""
    single_tile: bool = False
    """Whether only a picture in one tile can end at it."""

    def rate_target(self, value: float, pixels: int) -> RateTarget:
        """That of a picture of `pixels` pixels."""
        return RateTarget(self.quantity, value * pixels / 8 if self.per_pixel else value)


TARGETS = {
    "psnr": Target(
        "psnr",
        is_sound=lambda value: 0 < value < math.inf,
        rule="it must be positive",
        metavar="DB",
        noun="a number of dB",
        example="35 or 38.5",
        help="PSNR to end at, instead of -q.",
        tune="psnr",
    ),
    "ssimulacra2": Target(
        "score",
        is_sound=lambda value: -math.inf < value < 100,
        rule="it must be below 100",
        metavar="SCORE",
        noun="a SSIMULACRA 2 score",
        example="70 or 90",
        help="SSIMULACRA 2 score to end at, instead of -q.",
        single_tile=True,
    ),
    "size": Target(
        "bytes",
        is_sound=lambda value: 1 <= value < math.inf,
        rule="at least 1 byte",
        metavar="BYTES",
        noun="BYTES",
        example="20000, 200kB or 1.5MiB",
        help="File size to end at, never above: 20000, 200kB, 1.5MiB.",
    ),
    "bpp": Target(
        "bytes",
        is_sound=lambda value: 0 < value < math.inf,
        rule="it must be positive",
        metavar="X",
        noun="a number of bits per pixel",
        example="0.5",
        help="Bits per pixel to end at, never above.",
        per_pixel=True,
    ),
}
"""By the name of the setting, in the order in which help lists them: a stream may be asked for one."""
