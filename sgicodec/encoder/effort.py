"""The table of efforts: what an encode does at all, and how often, all of it from the steps of its fit.

`--effort` names a number of steps, `--steps` states one. docs/architecture.md, "Efforts", has the table as it comes
out. Thresholds were measured: docs/notes texture-share, settling, score-ascent, ladder, rdoq, encode-speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log2
from typing import Literal

from sgicodec.profiles.default import DEFAULT_LMBDA
from sgicodec.rdoq import RdoqSettings
from sgicodec.rdoq.texture import NO_SPLIT_SEARCH, SPLIT_SEARCH_MARGIN

Tune = Literal["psnr", "visual"]
"""Least squared error or the eye."""

PLAIN_STEPS = {1: 80, 2: 120, 3: 200, 4: 350, 5: 600, 6: 1000, 7: 2000, 8: 4000, 9: 8000}
"""Steps of each effort without texture."""
PSNR_STEPS = {1: 60, 2: 120, 3: 200, 4: 600, 5: 900, 6: 1400, 7: 2500, 8: 5000, 9: 10000}
"""The same towards least squared error with texture."""
VISUAL_STEPS = {1: 60, 2: 130, 3: 200, 4: 300, 5: 450, 6: 900, 7: 1600, 8: 3200, 9: 6400}
"""The same for the eye with texture, which sees more of texture than of what more steps give to seeds."""
DEFAULT_EFFORT = 4
_LOW_EFFORT_STEPS = 300
"""Beneath texture, from so many on, all that RDOQ and the search of texture have is worth its time."""
_SEED_POWER, _MIN_SEED_FACTOR = 0.6, 0.7
"""What `Effort.seed_lmbda` follows: for the eye it takes 0.4 % of bytes off at quality 30, 2 at 75 and 4.4 at 88,
towards squared error 0.6 at 30, 2.3 at 66 and 7 at 80 (docs/notes/2026-11-texture-share.md)."""
_RDOQ_STEPS = 100
"""From so many on, RDOQ is, for the eye: after 60 it takes a fifth of an encode's time and saves 1.3 % of its bytes
(docs/notes/2026-11-ladder.md)."""


@dataclass(frozen=True)
class Effort:
    """How much is done to a tile. Fields of texture mean nothing without it."""

    steps: int
    """Optimisation steps of the fit, all phases together."""
    seed_price: float
    """λ of the seeds in the fit, in the λ of the encode, at the default quality: what they leave costs less as texture
    than as more seeds, the shorter the fit, the more of it (docs/notes/2026-11-texture-share.md)."""
    rdoq: RdoqSettings
    """How RDOQ follows the fit: its passes, and how far each looks. From the fifth on they gain next to nothing."""
    split_margin: float
    """Up to how many times the cost of the other choice, by an estimate, a block of texture is tried whole or divided;
    1 trusts the estimate."""
    ascent_passes: int
    """Passes of gradient ascent on SSIMULACRA 2, each of which searches texture anew."""

    def seed_lmbda(self, lmbda: float) -> float:
        """λ of the seeds in the fit beneath texture, for the λ of an encode: the finer the steps of texture, the less
        of what it shows is worth a seed.
        """
        return lmbda * self.seed_price * max(float((DEFAULT_LMBDA / lmbda) ** _SEED_POWER), _MIN_SEED_FACTOR)


def steps_of(effort: int, tuned_for: Tune, has_texture: bool) -> int:
    """Steps of the fit at an effort of 1 to 9."""
    if not has_texture:
        return PLAIN_STEPS[effort]
    return VISUAL_STEPS[effort] if tuned_for == "visual" else PSNR_STEPS[effort]


def effort_of(steps: int, tuned_for: Tune, beneath_texture: bool = False) -> Effort:
    """What goes with a fit of so many steps. What a threshold switches on is worth its time from there on; before, more
    steps gain more in the same time.
    """
    is_low = beneath_texture and steps < _LOW_EFFORT_STEPS
    low_passes = int(steps >= _RDOQ_STEPS or tuned_for == "psnr")
    rdoq_passes = _within(2, round(steps / 250), 5)
    return Effort(
        steps=steps,
        seed_price=min(max(4.2 * float((200 / steps) ** 0.3), 2.1), 5.0),
        rdoq=RdoqSettings(low_passes, deep=1) if is_low else RdoqSettings(passes=rdoq_passes),
        split_margin=NO_SPLIT_SEARCH if is_low else SPLIT_SEARCH_MARGIN,
        ascent_passes=_passes(steps) if tuned_for == "visual" else 0,
    )


def _passes(steps: int) -> int:
    """Passes of ascent: another one for each 1.45 times the steps (docs/notes/2026-11-score-ascent.md, "Long moves
    first").
    """
    return _within(1, round(1.85 * log2(steps / 45)), 8)


def _within(low: int, value: int, high: int) -> int:
    return min(max(value, low), high)
