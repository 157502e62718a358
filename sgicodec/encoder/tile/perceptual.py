"""Texture for the eye: gradient ascent on SSIMULACRA 2. Seeds stay as they are, for errors that are least to them are
not to the eye.

The search weighs squared errors by frequency and place alone. The gradient of the score at what is decoded says which
of the errors that are left are seen. A target that has moved up the gradient makes the same search trade errors better:
squared error to it is a quadratic model of the score, renewed in each pass. The model holds near by only, so that
amplitudes move by a small part of their steps at a time.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.device import Device
from sgicodec.encoder.quality_calibration import CalibratedSteps
from sgicodec.encoder.tile.restoration import Strength, rendered_over
from sgicodec.encoder.tile.screen import Screen
from sgicodec.encoder.tile.state import TileState
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

Offsets = NDArray[np.int8] | None

_MEAN_MOVE = 0.015
"""Of amplitudes in a single pass, in steps (docs/notes/2026-11-ladder.md)."""
_SHORTER_BY_PASSES = 0.6
"""Power of the number of passes by which each moves less; in five, moves 30 % shorter or longer take up to 0.8 % more
bytes (docs/notes/2026-11-equal-losses.md)."""
_MAX_MOVE = 12.0
"""Of one amplitude, in means (docs/notes/2026-11-score-ascent.md)."""


def best_looking(state: TileState) -> TileState:
    """With texture of the best score for the bits at its λ, or for the quality that the plan is calibrated to."""
    state, search = state.begin_texture()
    tile, passes = state.tile, state.tile.effort.ascent_passes
    layer = state.best_layer(search, state.first_step)
    strength = state.best_strength(search, layer)
    screen = Screen(tile.spec, tile.picture.alpha is not None, tile.alpha)
    ascent = ScoreAscent(tile.unit, screen, tile.empty, tile.device, passes, strength)
    steps = CalibratedSteps(tile.plan.calibrated_quality, state.first_step, passes)
    for _ in range(passes):
        if tile.watch.ending() or layer is None:
            break
        score = ascent.climb(search, layer, state.step_offsets)
        layer = state.best_layer(search, steps.after(score), layer)
    return state.with_texture(layer, strength)


class ScoreAscent:
    """The ascent for layers of one picture in so many passes. unit [C, H, W]: what they are to show; screen: how that
    is seen; empty [H, W]: pixels that count nothing, None for none; strength: with which what is rendered is restored,
    None for not at all.
    """

    def __init__(
        self,
        unit: F32,
        screen: Screen,
        empty: NDArray[np.bool_] | None,
        device: Device,
        passes: int,
        strength: Strength | None = None,
    ) -> None:
        self.unit, self.screen, self.empty, self.device, self.strength = unit, screen, empty, device, strength
        self._mean_move = _MEAN_MOVE / passes**_SHORTER_BY_PASSES
        self._reference = VisualReference(screen.shown(unit), device)

    def climb(self, search: TextureSearch, layer: TextureSymbols, offsets: Offsets) -> float:
        """Moves the target of `search` from the layer that it found up the gradient, that of the layer's blocks alone.
        Returns SSIMULACRA 2 of the layer. offsets [rows, columns]: of its steps, None for none.
        """
        rendered = self._rendered(search, layer)
        score, shown = self._reference.gradient(self.screen.shown(rendered))
        gradient = self.screen.gradient(rendered, shown)
        if self.empty is not None:
            gradient[:, self.empty] = 0
        mean = self._mean_move
        search.move(gradient, layer.steps, offsets, mean, _MAX_MOVE * mean, layer)
        return score

    def _rendered(self, search: TextureSearch, symbols: TextureSymbols) -> F32:
        """What a layer shows over the seeds of `search`, restored."""
        rendered = rendered_over(search, self.unit, symbols, self.device)
        if self.strength is not None:
            rendered += self.strength.over(symbols).correction(rendered, self.device)
        if self.empty is not None:
            rendered[:, self.empty] = self.unit[:, self.empty]
        return rendered
