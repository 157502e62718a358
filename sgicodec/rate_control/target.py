"""What a stream may be asked to end at: the table of targets, and how far a measured stream is from one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

__all__ = ["LMBDA_MAX", "LMBDA_MIN", "TARGETS", "Measured", "RateTarget", "Target"]

LMBDA_MIN, LMBDA_MAX = 1e-6, 4.0
"""Range of λ in which rate control searches."""
SIZE_MIN_FRACTION = 0.97
"""Least part of the size that was asked for."""
SIZE_AIM_FRACTION = 0.99
"""Part of the size at which the rate error is zero: in the upper half of what is allowed."""
PSNR_TOLERANCE_DB = 0.1
"""How far a PSNR may lie from the one that was asked for."""
SIZE_OCTAVES_PER_LMBDA_OCTAVE = 0.65
"""log2 of the bytes that an octave of λ takes or gives, on photographs between 0.1 and 1 bpp."""
PSNR_DB_PER_LMBDA_OCTAVE = 1.5
SCORE_TOLERANCE = 1.0
"""How far a SSIMULACRA 2 score may lie from the one that was asked for."""
SCORE_PER_LMBDA_OCTAVE = 8.0
"""Of photographs between scores of 40 and 80; below, an octave takes more."""
SCORE_LMBDA = 0.5 * 2.0 ** (-49 / 8), 60.0
"""A λ, and the score that photographs have there: where the search for a score begins."""
PSNR_MAX_DB = 200.0
"""Stands for the infinite PSNR of a picture without error."""


@dataclass(frozen=True)
class Measured:
    """Bytes of a stream on disk; PSNR in dB and SSIMULACRA 2 score of its decoded samples, where they are asked for."""

    bytes: float
    psnr: float
    score: float = math.nan


class _Quantity(Protocol):
    """What of a stream a target is about; `found` is that of a stream, `wanted` the target."""

    def rate_error(self, found: float, wanted: float) -> float:
        """Octaves by which λ should rise."""

    def is_met(self, found: float, wanted: float) -> bool:
        """Whether it is near enough."""

    def is_missed(self, found: float, wanted: float) -> bool:
        """Whether the stream is larger than was allowed, or worse than was asked for."""

    def typical_lmbda(self, wanted: float) -> float | None:
        """λ at which photographs have it, where no R-D model predicts it."""

    def miss_message(self, found: float, wanted: float) -> str:
        """What to report of the best stream."""


class _Size:
    """Bytes: at most the target, and within 3 % of it."""

    def rate_error(self, found: float, wanted: float) -> float:
        return math.log2(max(found, 1.0) / (SIZE_AIM_FRACTION * wanted)) / SIZE_OCTAVES_PER_LMBDA_OCTAVE

    def is_met(self, found: float, wanted: float) -> bool:
        return SIZE_MIN_FRACTION * wanted <= found <= wanted

    def is_missed(self, found: float, wanted: float) -> bool:
        return found > wanted

    def typical_lmbda(self, wanted: float) -> float | None:
        return None

    def miss_message(self, found: float, wanted: float) -> str:
        return f"no stream of at most {wanted:.0f} bytes was found; the smallest has {found:.0f}"


@dataclass(frozen=True)
class _Quality:
    """What falls as λ rises, by `per_octave` of it: the target within `tolerance`. `largest` stands for all above;
    `typical`: as in `SCORE_LMBDA`; `text`, `reached`: how the target and a stream's are printed.
    """

    tolerance: float
    per_octave: float
    largest: float
    text: str
    reached: str
    typical: tuple[float, float] | None = None

    def rate_error(self, found: float, wanted: float) -> float:
        return (min(found, self.largest) - wanted) / self.per_octave

    def is_met(self, found: float, wanted: float) -> bool:
        return abs(found - wanted) <= self.tolerance

    def is_missed(self, found: float, wanted: float) -> bool:
        return found < wanted - self.tolerance

    def typical_lmbda(self, wanted: float) -> float | None:
        if self.typical is None:
            return None
        lmbda, value = self.typical
        return float(lmbda * 2.0 ** ((value - wanted) / self.per_octave))

    def miss_message(self, found: float, wanted: float) -> str:
        return f"no stream of {self.text.format(wanted)} was found; the best reaches {self.reached.format(found)}"


_QUANTITIES: dict[str, _Quantity] = {
    "bytes": _Size(),
    "psnr": _Quality(PSNR_TOLERANCE_DB, PSNR_DB_PER_LMBDA_OCTAVE, PSNR_MAX_DB, "{:g} dB", "{:.2f} dB"),
    "score": _Quality(*(SCORE_TOLERANCE, SCORE_PER_LMBDA_OCTAVE, math.inf), "SSIMULACRA 2 {:g}", "{:.1f}", SCORE_LMBDA),
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

    @property
    def _goal(self) -> tuple[str, float]:
        """Which field is asked for, and its value."""
        return next((name, value) for name in _QUANTITIES if (value := getattr(self, name)) is not None)

    def rate_error(self, measured: Measured) -> float:
        """Estimate of the octaves by which λ should rise: positive where the stream spends more than was asked for."""
        name, wanted = self._goal
        return _QUANTITIES[name].rate_error(getattr(measured, name), wanted)

    def is_met(self, measured: Measured) -> bool:
        """Size: at most the target, and within 3 % of it. PSNR: within 0.1 dB. Score: within 1."""
        name, wanted = self._goal
        return _QUANTITIES[name].is_met(getattr(measured, name), wanted)

    def is_missed(self, measured: Measured) -> bool:
        """Whether the stream is larger than was allowed, or worse than was asked for."""
        name, wanted = self._goal
        return _QUANTITIES[name].is_missed(getattr(measured, name), wanted)

    @property
    def typical_lmbda(self) -> float | None:
        """λ at which photographs have it, where no R-D model predicts it."""
        name, wanted = self._goal
        return _QUANTITIES[name].typical_lmbda(wanted)

    def nearest(self, streams: Sequence[Measured]) -> int:
        """Index of the stream with the least rate error, among those that do not miss the target if there are any."""
        sound = [index for index, measured in enumerate(streams) if not self.is_missed(measured)]
        return min(sound or range(len(streams)), key=lambda index: abs(self.rate_error(streams[index])))

    def best(self, streams: Sequence[Measured]) -> int:
        """Index of the stream with the fewest bytes for what it shows, among those that meet a PSNR or a score if there
        are any; else of the nearest.
        """
        met = [index for index, measured in enumerate(streams) if self.bytes is None and self.is_met(measured)]
        if not met:
            return self.nearest(streams)

        def cost(index: int) -> float:
            octaves = SIZE_OCTAVES_PER_LMBDA_OCTAVE * self.rate_error(streams[index])
            return math.log2(max(streams[index].bytes, 1.0)) - octaves

        return min(met, key=cost)

    def miss_message(self, measured: Measured) -> str:
        """What to report where the best stream misses the target."""
        name, wanted = self._goal
        return _QUANTITIES[name].miss_message(getattr(measured, name), wanted)


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
        is_sound=lambda value: value < 100,
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
