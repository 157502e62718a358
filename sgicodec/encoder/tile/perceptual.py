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
_MOMENTUM = 0.5
"""Part of the gradient of the pass before that each pass goes on with (docs/notes/2026-11-score-ascent.md)."""
_MAX_MOVE = 12.0
"""Of one amplitude, in means (docs/notes/2026-11-score-ascent.md)."""


def best_looking(state: TileState) -> TileState:
    """With texture of the best score for the bits at its λ, or for the quality that the plan is calibrated to."""
    state, search = state.begin_texture()
    tile, passes = state.tile, state.tile.effort.ascent_passes
    layer = state.best_layer(search, state.first_step)
    strength = state.best_strength(search, layer)
    screen = Screen(tile.spec, tile.picture.alpha is not None, tile.alpha)
    ascent = ScoreAscent(tile.unit, screen, tile.empty, tile.device, strength)
    steps = CalibratedSteps(tile.plan.calibrated_quality, state.first_step, passes)
    gradient = None
    for mean in mean_moves(passes):
        if tile.watch.ending() or layer is None:
            break
        score, gradient = ascent.climb(search, layer, state.step_offsets, mean, gradient)
        layer = state.best_layer(search, steps.after(score), layer)
    return state.with_texture(layer, strength)


def mean_moves(passes: int) -> list[float]:
    """Mean move of each pass of an ascent, in steps: the last ones are short, since no pass follows that would see what
    they made worse. Their sum grows with the square root of the passes.
    """
    return [2 * _MEAN_MOVE * (passes - number) / (passes**0.5 * (passes + 1)) for number in range(passes)]


class ScoreAscent:
    """The ascent for layers of one picture. unit [C, H, W]: what they are to show; screen: how that is seen; empty
    [H, W]: pixels that count nothing, None for none; strength: with which what is rendered is restored, None for not at
    all.
    """

    def __init__(
        self,
        unit: F32,
        screen: Screen,
        empty: NDArray[np.bool_] | None,
        device: Device,
        strength: Strength | None = None,
    ) -> None:
        self.unit, self.screen, self.empty, self.device, self.strength = unit, screen, empty, device, strength
        self._reference = VisualReference(screen.shown(unit), device)

    def climb(
        self, search: TextureSearch, layer: TextureSymbols, offsets: Offsets, mean: float, before: F32 | None = None
    ) -> tuple[float, F32]:
        """Moves the target of `search` from the layer that it found up the gradient, that of the layer's blocks alone.

        offsets [rows, columns]: of its steps, None for none; mean: of the moves, in steps; before [C, H, W]: what the
        pass before returned. Returns SSIMULACRA 2 of the layer, and what the target moved along [C, H, W].
        """
        rendered = self._rendered(search, layer)
        score, shown = self._reference.gradient(self.screen.shown(rendered))
        gradient = self.screen.gradient(rendered, shown)
        if before is not None:
            gradient += np.float32(_MOMENTUM) * before
        if self.empty is not None:
            gradient[:, self.empty] = 0
        search.move(gradient, layer.steps, offsets, mean, _MAX_MOVE * mean, layer)
        return score, gradient

    def _rendered(self, search: TextureSearch, symbols: TextureSymbols) -> F32:
        """What a layer shows over the seeds of `search`, restored."""
        rendered = rendered_over(search, self.unit, symbols, self.device)
        if self.strength is not None:
            rendered += self.strength.over(symbols).correction(rendered, self.device)
        if self.empty is not None:
            rendered[:, self.empty] = self.unit[:, self.empty]
        return rendered
