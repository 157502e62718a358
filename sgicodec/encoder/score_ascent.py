"""Gradient ascent of a texture layer on SSIMULACRA 2: what the layer should show moves, then it is searched anew.

The search weighs squared errors by frequency and place alone. The gradient of the score at what is decoded says which
of the errors that are left are seen. A target that has moved up the gradient makes the same search trade them better:
squared error to it is a quadratic model of the score, renewed in each pass. The model holds near by only, so that
amplitudes move by a small part of their steps at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.encoder.restoring import Strength
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.luma_space import from_luma_space
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["ScoreAscent", "ascent_passes"]

F32 = NDArray[np.float32]

Found = Callable[[TextureSymbols | None, float | None], TextureSymbols | None]

MEAN_MOVE = 0.005
"""Of amplitudes in all passes, in steps, times the root of their number."""
MOST_MOVE = 40.0
"""Of one amplitude, in means."""
STEPS_PER_PASS, MOST_PASSES = 125, 8
"""Steps of a fit that are worth another pass, and how many there are at most."""


def ascent_passes(steps: int) -> int:
    """Passes for a fit of this many steps."""
    return min(1 + steps // STEPS_PER_PASS, MOST_PASSES)


@dataclass(frozen=True)
class ScoreAscent:
    """The ascent for layers of one picture. unit [C, H, W]: what they are to show, in luma space where `luma_space`;
    empty [H, W]: pixels that count nothing, None for none; strength: with which what is drawn is restored, None for not
    at all.
    """

    unit: F32
    luma_space: bool
    empty: NDArray[np.bool_] | None
    device: Device
    strength: Strength | None = None

    def run(
        self,
        search: TextureSearch,
        found: Found,
        contrast: NDArray[np.int8] | None,
        passes: int,
        ending: Callable[[], bool] = lambda: False,
    ) -> tuple[TextureSymbols | None, float | None]:
        """Moves the target of `search` in this many passes, or until `ending`. `found` gives its best layer with these
        contrasts, of the cells of the layer before or, with None, of any; it is told the score of that layer, too.

        Returns the last layer that was found, and its score if it has one.
        """
        reference, mean = VisualReference(self._seen(self.unit), self.device), MEAN_MOVE / passes**0.5
        symbols = score = None
        for _ in range(passes):
            if ending() or (symbols := found(symbols, score)) is None:
                break
            drawn = self.unit - search.residual + symbols.layer().draw(device=self.device)
            if self.strength is not None:
                drawn += self.strength.over(symbols).correction(drawn, self.device)
            if self.empty is not None:
                drawn[:, self.empty] = self.unit[:, self.empty]
            score, gradient = reference.gradient(self._seen(drawn))
            if self.empty is not None:
                gradient[:, self.empty] = 0
            search.move(self._in_unit(gradient), symbols.steps, contrast, mean, MOST_MOVE * mean)
        return symbols, score

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
