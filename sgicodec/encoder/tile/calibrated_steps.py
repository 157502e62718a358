"""Steps of texture on the way to the score that a quality has in the mean of pictures."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

__all__ = ["CalibratedSteps"]

_QUALITIES = (1.0, 10.0, 20.0, 30.0, 44.0, 57.0, 70.0, 83.0, 90.0, 97.0, 100.0)
_SCORES = (-45.0, -21.0, 3.0, 25.5, 51.5, 68.7, 80.3, 87.9, 90.5, 92.7, 93.6)
"""SSIMULACRA 2 that a quality has in the mean of pictures (docs/notes/2026-11-same-look.md)."""
_PER_QUALITY, _MAX_MOVE = 2.5, 32
"""Indices of texture's steps for a step of quality, which would be 2 if seeds followed, and the most that they move."""
_NEARLY, _GAIN = 1.5, 1.1
"""Steps of quality that a score may be off, and that a pass gains; several gain with the root of their number."""


@dataclass
class CalibratedSteps:
    """The index of texture's steps on the way to the look of a quality, `quality` None for none, in the course of so
    many passes of gradient ascent.

    What a pass gains belongs to its steps. So they stay in the last pass, if there are two; and a score that
    is nearly right is left alone.
    """

    quality: float | None
    step: int
    passes: int
    _begin: int = field(init=False)
    _scores: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._begin = self.step

    def after(self, score: float | None) -> int:
        """The index for the next layer, if the last one had this SSIMULACRA 2 score; None where there was none."""
        if self.quality is None or score is None or self._scores == max(1, self.passes - 1):
            return self.step
        to_come = _GAIN * (self.passes - self._scores) ** 0.5
        self._scores += 1
        off = float(np.interp(score, _SCORES, _QUALITIES)) + to_come - self.quality
        too_far = off - float(np.clip(off, -_NEARLY, _NEARLY))
        moved = self.step - self._begin + round(_PER_QUALITY * too_far)
        self.step = self._begin + min(max(moved, -_MAX_MOVE), _MAX_MOVE)
        return self.step
