"""Encodes a picture as one tile to a rate target by its texture: seeds are fitted once, then its step moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from sgicodec.encoder.target_encoder import Stream, TargetEncoder
from sgicodec.model.texture_symbols import STEP_COUNT
from sgicodec.rate_control.rd_model import initial_lmbda
from sgicodec.rate_control.step_search import SHIFT_MAX, step_shift
from sgicodec.rate_control.target import LMBDA_MAX, LMBDA_MIN, Measured

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["TextureTargetEncoder"]

MAX_FITS = 2
FAR_OCTAVES = 1.5
"""Octaves of λ between seeds and texture from which on another fit is worth its time."""
OCTAVES_PER_UNIT = -1 / 16
"""Octaves of λ that a unit of the texture's step stands for: a 32nd of an octave of the step."""

RESOLUTION = 0.25
"""Of the shift of the step, in its units."""


class TextureTargetEncoder(TargetEncoder):
    """Takes an encoding to a rate target. λ of the seeds is what the R-D model predicts; the texture's step does the
    rest, and where it would have to go far, seeds are fitted once more.
    """

    def _best(self, on_progress: Callable[[Progress], bool]) -> Stream:
        """The nearest stream of as many fits as it takes."""
        encoding, target = self.encoding, self.target
        lmbda, found = initial_lmbda(target, encoding.rd_model(), self._extra()), []
        if target.bytes is not None:
            lmbda = min(lmbda * 2.0**encoding.tuning.larger, LMBDA_MAX)
        for _ in range(1 if encoding.settings.time_limit is not None else MAX_FITS):
            encoding.begin(lmbda)
            stream, octaves = self._stream(on_progress)
            found.append(stream)
            lmbda = min(max(lmbda * 2.0**octaves, LMBDA_MIN), LMBDA_MAX)
            if self.ended or (target.is_met(stream[1]) and abs(octaves) < FAR_OCTAVES):
                break
        return found[target.best([measured for _, measured in found])]

    def _stream(self, on_progress: Callable[[Progress], bool]) -> tuple[Stream, float]:
        """The best stream with seeds for the encoding's λ, and by how many octaves λ should have been larger."""
        encoding, target = self.encoding, self.target
        # Without two passes, the seeds of a fit that was ended early may take more than the whole stream is to have.
        candidate = encoding.searched(encoding.candidate(encoding.fitted(on_progress)), least=2)
        search, first = encoding.texture_search(candidate), encoding.tuning.step(encoding.lmbda)
        tried: dict[float, Stream] = {}
        none_from = math.inf  # the shift from which on there is no texture

        def step_at(shift: float) -> int:
            return min(max(first + math.floor(shift), 0), STEP_COUNT - 1)

        def measure(shift: float) -> Measured:
            nonlocal none_from
            if shift > none_from:
                tried[shift] = tried[none_from]
                return tried[shift][1]
            # Between two steps, the price of bits moves as much as the step would.
            price = encoding.tuning.squared_steps * 2.0 ** (-OCTAVES_PER_UNIT * (shift % 1))
            textured = encoding.with_texture(candidate, search, step_at(shift), price)
            if textured.model.texture is None:
                none_from = shift
            tried[shift] = encoding.measured(textured)
            return tried[shift][1]

        # What follows is for the texture about where the target will be met.
        near = round(min(max(target.rate_error(measure(0.0)) / -OCTAVES_PER_UNIT, -SHIFT_MAX), SHIFT_MAX))
        if encoding.tuning.ascends:
            encoding.ascend(candidate, search, step_at(near))
        else:
            candidate = encoding.settled(candidate, step_at(near))
            search = encoding.texture_search(candidate)
        none_from = math.inf
        tried.clear()
        shift = near + step_shift(target, lambda moved: measure(near + moved), OCTAVES_PER_UNIT, RESOLUTION)
        octaves = -OCTAVES_PER_UNIT * shift
        if not target.is_met(tried[shift][1]):
            octaves += target.rate_error(tried[shift][1])
        return tried[shift], octaves
