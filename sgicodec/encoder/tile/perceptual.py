"""Texture for the eye: gradient ascent on two scores says which errors are seen. Seeds stay as they are, for errors
that are least to them are not to the eye.
"""

from __future__ import annotations

from dataclasses import replace

from sgicodec.encoder.tile.calibrated_steps import CalibratedSteps
from sgicodec.encoder.tile.score_ascent import Contrast, ScoreAscent
from sgicodec.encoder.tile.state import TileState
from sgicodec.encoder.tile.texture import begin_texture, best_layer, best_strength
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["Perceptual"]


class Perceptual:
    """The `TextureStrategy` of the best scores for the bits."""

    def lay(self, state: TileState) -> TileState:
        """As in `TextureStrategy`, or for the quality that the plan is calibrated to."""
        state, search = begin_texture(state)
        tuning = state.tile.tuning
        price = tuning.price(state.lmbda)
        state, cells, step = self._ascended(state, search, tuning.step(state.lmbda), price)
        return state.with_texture(best_layer(state, search, step, price, cells), state.strength)

    def aim(self, state: TileState, search: TextureSearch, step: int) -> tuple[TileState, TextureSearch]:
        """As in `TextureStrategy`: with what the ascent made of the search."""
        return self._ascended(state, search, step)[0], search

    def lay_at(self, state: TileState, search: TextureSearch, step: int, price: float | None = None) -> TileState:
        """As in `TextureStrategy`."""
        return state.with_texture(best_layer(state, search, step, price), state.strength)

    def _ascended(
        self, state: TileState, search: TextureSearch, step: int, price: float | None = None
    ) -> tuple[TileState, TextureSymbols | None, int]:
        """The tile with the contrasts and the restoration of layers for the eye, the last of these layers, and the step
        of the next. Moves what `search` looks for.
        """
        tile, passes = state.tile, state.tile.effort.ascent_passes
        first = best_layer(state, search, step, price)
        state = replace(state, strength=best_strength(state, search, first))
        ascent = ScoreAscent(tile.unit, tile.spec.luma_space, tile.empty, tile.device, state.strength)
        steps = CalibratedSteps(tile.plan.calibrated_quality, step, passes)

        def next_layer(cells: TextureSymbols | None, score: float | None, contrast: Contrast) -> TextureSymbols | None:
            if score is None:
                return first
            return best_layer(replace(state, contrast=contrast), search, steps.after(score), price, cells)

        cells, score, contrast = ascent.run(search, next_layer, state.contrast, passes, tile.watch.ending)
        return replace(state, contrast=contrast), cells, steps.after(score)
