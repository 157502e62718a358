"""Texture for the eye: gradient ascent on two scores says which errors are seen. Seeds stay as they are, for errors
that are least to them are not to the eye.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sgicodec.encoder.tile.score_ascent import Offsets, ScoreAscent
from sgicodec.encoder.tile.state import TileState
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["CalibratedSteps", "Perceptual"]


class Perceptual:
    """Texture of the best scores for the bits."""

    def lay(self, state: TileState) -> TileState:
        """As in `LeastSquares`, or for the quality that the plan is calibrated to."""
        state, search = state.begin_texture()
        tuning = state.tile.tuning
        price = tuning.price(state.lmbda)
        state, blocks, step = self._ascended(state, search, tuning.step(state.lmbda), price)
        return state.with_texture(state.best_layer(search, step, price, blocks), state.strength)

    def aim(self, state: TileState, search: TextureSearch, step: int) -> tuple[TileState, TextureSearch]:
        """As in `LeastSquares`: with what the ascent made of the search."""
        return self._ascended(state, search, step)[0], search

    def lay_at(self, state: TileState, search: TextureSearch, step: int, price: float | None = None) -> TileState:
        """As in `LeastSquares`."""
        return state.with_texture(state.best_layer(search, step, price), state.strength)

    def _ascended(
        self, state: TileState, search: TextureSearch, step: int, price: float | None = None
    ) -> tuple[TileState, TextureSymbols | None, int]:
        """The tile with the step offsets and the restoration of layers for the eye, the last of these layers, and the
        step of the next. Moves what `search` looks for.
        """
        tile, passes = state.tile, state.tile.effort.ascent_passes
        first = state.best_layer(search, step, price)
        state = replace(state, strength=state.best_strength(search, first))
        ascent = ScoreAscent(tile.unit, tile.spec.luma_space, tile.empty, tile.device, state.strength)
        steps = CalibratedSteps(tile.plan.calibrated_quality, step, passes)

        def next_layer(blocks: TextureSymbols | None, score: float | None, offsets: Offsets) -> TextureSymbols | None:
            if score is None:
                return first
            return replace(state, step_offsets=offsets).best_layer(search, steps.after(score), price, blocks)

        blocks, score, offsets = ascent.run(search, next_layer, state.step_offsets, passes, tile.watch.ending)
        return replace(state, step_offsets=offsets), blocks, steps.after(score)


_QUALITIES = (1.0, 10.0, 20.0, 30.0, 44.0, 57.0, 70.0, 83.0, 90.0, 97.0, 100.0)
_SCORES = (-45.0, -21.0, 3.0, 25.5, 51.5, 68.7, 80.3, 87.9, 90.5, 92.7, 93.6)
"""SSIMULACRA 2 that a quality has in the mean of pictures (docs/notes/2026-11-same-look.md)."""
_PER_QUALITY, _MAX_MOVE = 2.5, 32
"""Indices of texture's steps for a step of quality, which would be 2 if seeds followed, and the most that they move
(docs/notes/2026-11-same-look.md, 2026-11-equal-losses.md)."""
_NEARLY, _GAIN = 1.5, 1.1
"""Steps of quality that a score may be off, and that a pass gains; several gain with the root of their number
(docs/notes/2026-11-same-look.md)."""


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
