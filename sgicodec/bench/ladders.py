"""What the points of a curve of sgi stand for in each profile, and which are measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

__all__ = ["LADDERS", "QUALITIES", "Ladder", "ladder_of", "profile_of"]


@dataclass(frozen=True)
class Ladder:
    """The points of a curve.

    name: what a value is, as rows of results name it. values: the points that are measured, by rising rate. options: of
    `sgi encode`, for a value and a number of pixels. has_efforts: whether `-e` goes with them.
    """

    name: str
    values: tuple[float, ...]
    options: Callable[[float, int], tuple[str, ...]]
    has_efforts: bool = False


def _seeds(per_megapixel: float, pixels: int) -> tuple[str, ...]:
    return ("--seeds", str(max(1, round(per_megapixel * pixels / 1e6))))


QUALITIES = Ladder(
    "quality", (20.0, 35.0, 50.0, 65.0, 80.0), lambda quality, pixels: ("-q", f"{quality:g}"), has_efforts=True
)
"""Of the default profile."""

LADDERS = {
    "default": QUALITIES,
    "paper": Ladder("seeds-per-megapixel", (450.0, 900.0, 1800.0, 3600.0, 7200.0), _seeds),
}
"""By profile. The paper draws its curves over the number of Gaussians at one λ: 1,800 seeds a megapixel are 50,000
Gaussians for a picture of 2,048×1,363 pixels. Another λ is an option of the curve.
"""


def profile_of(options: Sequence[str]) -> str:
    """The profile that options of `sgi encode` choose; the last of them counts."""
    chosen = "default"
    for index, word in enumerate(options):
        name, equals, value = word.partition("=")
        if name == "--profile":
            chosen = value if equals else "".join(options[index + 1 : index + 2])
    return chosen


def ladder_of(options: Sequence[str]) -> Ladder:
    """The ladder of the profile that options choose; that of the default profile for one that does not exist, which
    the command refuses.
    """
    return LADDERS.get(profile_of(options), QUALITIES)
