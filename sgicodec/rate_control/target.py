"""What a stream may be asked to end at: the table of targets, and how far a measured stream is from one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

__all__ = ["TARGETS", "Measured", "RateTarget", "Target"]

SIZE_MIN_FRACTION = 0.97
"""Least part of the size that was asked for."""
SIZE_AIM_FRACTION = 0.985
"""Part of the size at which the rate error is zero: in the middle of what is allowed."""
PSNR_TOLERANCE_DB = 0.1
"""How far a PSNR may lie from the one that was asked for."""
SIZE_OCTAVES_PER_LMBDA_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
PSNR_DB_PER_LMBDA_OCTAVE = 1.5
SCORE_TOLERANCE = 1.0
"""How far a SSIMULACRA 2 score may lie from the one that was asked for."""
SCORE_PER_LMBDA_OCTAVE = 8.0
"""Of photographs between scores of 40 and 80; below, an octave takes more."""
PSNR_MAX_DB = 200.0
"""Stands for the infinite PSNR of a picture without error."""


@dataclass(frozen=True)
class Measured:
    """Bytes of a stream on disk; PSNR in dB and SSIMULACRA 2 score of its decoded samples, where they are asked for."""

    bytes: float
    psnr: float
    score: float = math.nan


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


_QUANTITIES = {
    "bytes": _Quantity(
        SIZE_OCTAVES_PER_LMBDA_OCTAVE,
        near=lambda wanted: (SIZE_MIN_FRACTION * wanted, wanted),
        asked="at most {:.0f} bytes",
        reached="smallest has {:.0f}",
        is_size=True,
    ),
    "psnr": _Quantity(
        PSNR_DB_PER_LMBDA_OCTAVE,
        near=lambda wanted: (wanted - PSNR_TOLERANCE_DB, wanted + PSNR_TOLERANCE_DB),
        asked="{:g} dB",
        reached="best reaches {:.2f} dB",
        largest=PSNR_MAX_DB,
    ),
    "score": _Quantity(
        SCORE_PER_LMBDA_OCTAVE,
        near=lambda wanted: (wanted - SCORE_TOLERANCE, wanted + SCORE_TOLERANCE),
        asked="SSIMULACRA 2 {:g}",
        reached="best reaches {:.1f}",
    ),
}
"""By the field of `Measured` and of `RateTarget`."""


@dataclass(frozen=True)
class RateTarget:
    """A size in bytes that the stream must not exceed, or a PSNR in dB or a SSIMULACRA 2 score that it must have: one
    of the three.
    """

    bytes: float | None = None
    psnr: float | None = None
    score: float | None = None

    def _asked(self) -> tuple[str, float]:
        """The field that is asked for, and its value."""
        values = ((name, getattr(self, name)) for name in _QUANTITIES)
        return next((name, value) for name, value in values if value is not None)

    def measure(self, size: float, psnr: Callable[[], float], score: Callable[[], float]) -> Measured:
        """What a stream of so many bytes is; of its PSNR and score, only what is asked for is computed."""
        return Measured(
            size,
            math.inf if self.psnr is None else psnr(),
            math.nan if self.score is None else score(),
        )

    def rate_error(self, measured: Measured) -> float:
        """Estimate of the octaves by which λ should rise: positive where the stream spends more than was asked for."""
        name, wanted = self._asked()
        quantity, found = _QUANTITIES[name], getattr(measured, name)
        if quantity.is_size:
            return math.log2(max(found, 1.0) / (SIZE_AIM_FRACTION * wanted)) / quantity.per_octave
        return float(min(found, quantity.largest) - wanted) / quantity.per_octave

    def is_met(self, measured: Measured) -> bool:
        """Size: at most the target, and within 3 % of it. PSNR: within 0.1 dB. Score: within 1."""
        name, wanted = self._asked()
        low, high = _QUANTITIES[name].near(wanted)
        return bool(low <= getattr(measured, name) <= high)

    def is_missed(self, measured: Measured) -> bool:
        """Whether the stream is larger than was allowed, or worse than was asked for."""
        name, wanted = self._asked()
        (low, high), found = _QUANTITIES[name].near(wanted), getattr(measured, name)
        return bool(found > high if _QUANTITIES[name].is_size else found < low)

    def nearest(self, streams: Sequence[Measured]) -> int:
        """Index of the stream with the least rate error, among those that do not miss the target if there are any."""
        sound = [index for index, measured in enumerate(streams) if not self.is_missed(measured)]
        return min(sound or range(len(streams)), key=lambda index: abs(self.rate_error(streams[index])))

    def miss_message(self, measured: Measured) -> str:
        """What to report where the best stream misses the target."""
        name, wanted = self._asked()
        asked, found = _QUANTITIES[name].asked, _QUANTITIES[name].reached.format(getattr(measured, name))
        return f"no stream of {asked.format(wanted)} was found; the {found}"


@dataclass(frozen=True)
class Target:
    """A setting that names a rate target, and an option of the command line of the same name."""

    quantity: Literal["bytes", "psnr", "score"]
    """Which field of `RateTarget` it sets."""
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
        return RateTarget(**{self.quantity: value * pixels / 8 if self.per_pixel else value})


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
