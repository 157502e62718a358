"""Texture for the eye: gradient ascent on SSIMULACRA 2. Seeds stay as they are, for errors that are least to them are
not to the eye.

The search weighs squared errors by frequency and place alone. The gradient of the score at what is decoded says which
of the errors that are left are seen. A target that has moved up the gradient makes the same search trade errors better:
squared error to it is a quadratic model of the score, renewed in each pass. The model holds near by only, so that
amplitudes move by a small part of their steps at a time.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.encoder.quality_calibration import CalibratedSteps
from sgicodec.encoder.tile.restoration import Strength, rendered_over
from sgicodec.encoder.tile.state import TileState
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.luma_space import from_luma_space
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["Perceptual", "ScoreAscent"]

F32 = NDArray[np.float32]
Offsets = NDArray[np.int8] | None

MEAN_MOVE = 0.015
"""Of amplitudes in a single pass, in steps (docs/notes/2026-11-ladder.md)."""
SHORTER_BY_PASSES = 0.6
"""Power of the number of passes by which each moves less; in five, moves 30 % shorter or longer take up to 0.8 % more
bytes (docs/notes/2026-11-equal-losses.md)."""
MAX_MOVE = 12.0
"""Of one amplitude, in means (docs/notes/2026-11-score-ascent.md)."""


class Perceptual:
    """Texture of the best score for the bits."""

    def lay(self, state: TileState) -> TileState:
        """As in `LeastSquares`, or for the quality that the plan is calibrated to."""
        state, search = state.begin_texture()
        tuning = state.tile.tuning
        price = tuning.price(state.lmbda)
        state, blocks, step = self._ascended(state, search, tuning.step(state.lmbda), price, blocks_stay=True)
        return state.with_texture(state.best_layer(search, step, price, blocks), state.strength)

    def aim(self, state: TileState, search: TextureSearch, step: int) -> tuple[TileState, TextureSearch]:
        """As in `LeastSquares`: with what the ascent made of the search."""
        return self._ascended(state, search, step)[0], search

    def lay_at(self, state: TileState, search: TextureSearch, step: int, price: float | None = None) -> TileState:
        """As in `LeastSquares`."""
        return state.with_texture(state.best_layer(search, step, price), state.strength)

    def _ascended(
        self,
        state: TileState,
        search: TextureSearch,
        step: int,
        price: float | None = None,
        blocks_stay: bool = False,
    ) -> tuple[TileState, TextureSymbols | None, int]:
        """The tile with the restoration of layers for the eye, the last of these layers, and the step of the next one.
        Moves what `search` looks for; blocks_stay: for the blocks of these layers alone.
        """
        tile, passes = state.tile, state.tile.effort.ascent_passes
        first = state.best_layer(search, step, price)
        state = replace(state, strength=state.best_strength(search, first))
        seen = (tile.unit, tile.spec.luma_space, tile.empty)
        ascent = ScoreAscent(*seen, tile.device, passes, state.strength)
        steps = CalibratedSteps(tile.plan.calibrated_quality, step, passes)
        layer: TextureSymbols | None = None
        score: float | None = None
        for _ in range(passes):
            if tile.watch.ending():
                break
            layer = first if score is None else state.best_layer(search, steps.after(score), price, layer)
            if layer is None:
                break
            score = ascent.climb(search, layer, state.step_offsets, blocks_stay)
        return state, layer, steps.after(score)


class ScoreAscent:
    """The ascent for layers of one picture in so many passes. unit [C, H, W]: what they are to show, in luma space
    where `luma_space`; empty [H, W]: pixels that count nothing, None for none; strength: with which what is rendered is
    restored, None for not at all.
    """

    def __init__(
        self,
        unit: F32,
        luma_space: bool,
        empty: NDArray[np.bool_] | None,
        device: Device,
        passes: int,
        strength: Strength | None = None,
    ) -> None:
        self.unit, self.luma_space, self.empty, self.device, self.strength = unit, luma_space, empty, device, strength
        self._mean_move = MEAN_MOVE / passes**SHORTER_BY_PASSES
        self._reference = VisualReference(self._seen(unit), device)

    def climb(
        self,
        search: TextureSearch,
        layer: TextureSymbols,
        offsets: Offsets,
        blocks_stay: bool = False,
    ) -> float:
        """Moves the target of `search` from the layer that it found up the gradient, that of the layer's blocks alone
        where these stay. Returns SSIMULACRA 2 of the layer. offsets [rows, columns]: of its steps, None for none.
        """
        rendered = self._rendered(search, layer)
        score, gradient = self._reference.gradient(self._seen(rendered))
        gradient = self._in_unit(gradient)
        if self.empty is not None:
            gradient[:, self.empty] = 0
        mean, blocks = self._mean_move, layer if blocks_stay else None
        search.move(gradient, layer.steps, offsets, mean, MAX_MOVE * mean, blocks)
        return score

    def _rendered(self, search: TextureSearch, symbols: TextureSymbols) -> F32:
        """What a layer shows over the seeds of `search`, restored."""
        rendered = rendered_over(search, self.unit, symbols, self.device)
        if self.strength is not None:
            rendered += self.strength.over(symbols).correction(rendered, self.device)
        if self.empty is not None:
            rendered[:, self.empty] = self.unit[:, self.empty]
        return rendered

    def _seen(self, planes: F32) -> F32:
        """Samples as they are seen."""
        if not self.luma_space:
            return planes
        return np.tensordot(from_luma_space(len(planes)).astype(np.float32), planes, axes=1)

    def _in_unit(self, gradient: F32) -> F32:
        """A gradient in samples as they are seen, in those of `unit`."""
        if not self.luma_space:
            return gradient
        return np.tensordot(from_luma_space(len(gradient)).T.astype(np.float32), gradient, axes=1)
