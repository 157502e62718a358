"""How a tile is restored: with the strength that brings what is drawn nearest to the picture, or not at all."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.encoder.adapting import adapted
from sgicodec.model.restoration import Restoration
from sgicodec.model.texture_symbols import STEP_COUNT, TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["Restorer", "Strength"]

F32 = NDArray[np.float32]

_OFFSETS, _APART = (-40, -24, -8, 8), 16
"""Steps that are tried, from texture's own, in 32nds of an octave."""
_STRONGER = {1: 0, 2: 8, 3: 4}
"""By network, how far above the step of least squared error it does best."""
_LARGER = {1: 1.0, 2: 1.02, 3: 1.02}
"""By network, what squared error may grow by: the one for the eye gains by what squared error does not tell."""
_BITS = 21
"""That a stream takes for it: the part, and a byte of the header."""


@dataclass(frozen=True)
class Strength:
    """A network, how far its step is above texture's (the larger the step, the more it takes away), and what is added
    to its layers.
    """

    network: int
    offset: int
    changes: tuple[NDArray[np.int32], ...] = ()

    def over(self, texture: TextureSymbols) -> Restoration:
        """Restoration of what is drawn with a layer."""
        step = min(max(texture.steps.step + self.offset, 0), STEP_COUNT - 1)
        return Restoration(self.network, step, self.changes)


@dataclass(frozen=True)
class Restorer:
    """For layers of one picture. unit [C, H, W]: what is to be shown; empty [H, W]: pixels that count nothing, None for
    none; network: number of the shipped one.
    """

    unit: F32
    empty: NDArray[np.bool_] | None
    network: int
    device: Device

    def correction(self, search: TextureSearch, texture: TextureSymbols, strength: Strength) -> F32:
        """What restoration adds to a layer over the seeds of `search`."""
        return strength.over(texture).correction(self._drawn(search, texture), self.device)

    def strength(self, search: TextureSearch, texture: TextureSymbols, lmbda: float = 0.0) -> Strength | None:
        """What makes a layer over the seeds of `search` best, None where none makes it better by what its bits are
        worth.
        """
        drawn = self._drawn(search, texture)

        def error(offset: int) -> float:
            return self._error(drawn + Strength(self.network, offset).over(texture).correction(drawn, self.device))

        least = _least([error(offset) for offset in _OFFSETS])
        found = Strength(self.network, least + _STRONGER[self.network])
        if error(found.offset) + _BITS * lmbda < _LARGER[self.network] * self._error(drawn):
            return found
        return None

    def adapted(self, search: TextureSearch, texture: TextureSymbols, strength: Strength, lmbda: float) -> Strength:
        """The same with a last layer that suits what a layer over the seeds of `search` shows."""
        drawn = self._drawn(search, texture)
        found = adapted(strength.over(texture), drawn, self.unit, self.empty, lmbda, self.device)
        return replace(strength, changes=found.changes)

    def _error(self, shown: F32) -> float:
        if self.empty is not None:
            shown[:, self.empty] = self.unit[:, self.empty]
        return float(np.square(self.unit - shown).sum(dtype=np.float64))

    def _drawn(self, search: TextureSearch, texture: TextureSymbols) -> F32:
        drawn = self.unit - search.residual + texture.layer().draw(device=self.device)
        if self.empty is not None:
            drawn[:, self.empty] = self.unit[:, self.empty]
        return drawn


def _least(errors: list[float]) -> int:
    """Where a parabola through the least of the errors at _OFFSETS and those beside it is lowest."""
    best = int(np.argmin(errors))
    if not 0 < best < len(errors) - 1:
        return _OFFSETS[best]
    before, here, after = errors[best - 1 : best + 2]
    curvature = before - 2.0 * here + after
    return _OFFSETS[best] + (round(_APART / 2 * (before - after) / curvature) if curvature > 0 else 0)
