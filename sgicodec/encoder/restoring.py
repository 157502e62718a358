"""Whether a tile is restored: where the network of its tuning brings what is drawn nearer to the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.model.restoration import Restoration
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["Restorer"]

F32 = NDArray[np.float32]

_LARGER = {1: 1.0, 2: 1.04}
"""By network, what squared error may grow by: the one for the eye gains by what squared error does not tell."""
_BITS = 21
"""That a stream takes for it: the part, and a byte of the header."""


@dataclass(frozen=True)
class Restorer:
    """For layers of one picture. unit [C, H, W]: what is to be shown; empty [H, W]: pixels that count nothing, None for
    none; network: number of the shipped one.
    """

    unit: F32
    empty: NDArray[np.bool_] | None
    network: int
    device: Device

    def correction(self, search: TextureSearch, texture: TextureSymbols) -> F32:
        """What restoration adds to a layer over the seeds of `search`."""
        return self._restoration(texture).correction(self._drawn(search, texture), self.device)

    def helps(self, search: TextureSearch, texture: TextureSymbols, lmbda: float = 0.0) -> bool:
        """Whether restoration makes a layer over the seeds of `search` better by what its bits are worth."""
        drawn = self._drawn(search, texture)
        restored = drawn + self._restoration(texture).correction(drawn, self.device)
        if self.empty is not None:
            restored[:, self.empty] = self.unit[:, self.empty]
        error, before = (np.square(self.unit - one).sum(dtype=np.float64) for one in (restored, drawn))
        return bool(error + _BITS * lmbda < _LARGER[self.network] * before)

    def _restoration(self, texture: TextureSymbols) -> Restoration:
        return Restoration(self.network, texture.steps.step)

    def _drawn(self, search: TextureSearch, texture: TextureSymbols) -> F32:
        drawn = self.unit - search.residual + texture.layer().draw(device=self.device)
        if self.empty is not None:
            drawn[:, self.empty] = self.unit[:, self.empty]
        return drawn
