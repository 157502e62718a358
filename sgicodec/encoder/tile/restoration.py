"""How a tile is restored: with the strength that brings what is rendered nearest to the picture, or not at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.device import Device
from sgicodec.model.restoration import Restoration
from sgicodec.model.texture_symbols import TEXTURE_STEP_COUNT, TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

_OFFSETS, _APART = (-32, -12, 8), 20
"""Steps that are tried, from texture's own, in 32nds of an octave. Four, 16 apart, gain 0.0 % of bytes; one loses 0.8 %
by Butteraugli (ten pictures, effort 1)."""
_BITS = 21
"""That a stream takes for it: the part, and a byte of the header."""
_LOOKED_AT, _BAND, _MARGIN = 1 << 16, 64, 4
"""Pixels that strengths are compared on, in bands of so many rows; rows at their edges that depend on what lies beyond.
"""


@dataclass(frozen=True)
class Strength:
    """A network, and how far its step is above texture's: the larger the step, the more it takes away."""

    network: int | bytes
    offset: int

    def over(self, texture: TextureSymbols) -> Restoration:
        """Restoration of what is rendered with a layer."""
        step = min(max(texture.steps.step + self.offset, 0), TEXTURE_STEP_COUNT - 1)
        return Restoration(self.network, step)


@dataclass(frozen=True)
class Restorer:
    """For layers of one picture. unit [C, H, W]: what is to be shown; empty [H, W]: pixels that count nothing, None for
    none; network: as in `Restoration`; worth: as in `TextureTuning`.
    """

    unit: F32
    empty: NDArray[np.bool_] | None
    network: int | bytes
    worth: float
    device: Device

    def correction(self, search: TextureSearch, texture: TextureSymbols, strength: Strength) -> F32:
        """What restoration adds to a layer over the seeds of `search`."""
        return strength.over(texture).correction(self._rendered(search, texture), self.device)

    def strength(self, search: TextureSearch, texture: TextureSymbols, lmbda: float = 0.0) -> Strength | None:
        """What makes a layer over the seeds of `search` best, None where none makes it better by what its bits are
        worth. Of a large tile, bands of rows are looked at.
        """
        rows, counted = _bands(*self.unit.shape[1:])
        rendered, wanted = self._rendered(search, texture)[:, rows], self.unit[:, rows]

        def error(strength: Strength | None) -> float:
            shown = (
                rendered if strength is None else rendered + strength.over(texture).correction(rendered, self.device)
            )
            left = (wanted - shown)[:, counted]
            if self.empty is not None:
                left[:, self.empty[rows[counted]]] = 0
            return float(np.square(left).sum(dtype=np.float64))

        strength = Strength(self.network, _least([error(Strength(self.network, offset)) for offset in _OFFSETS]))
        bits = _BITS * counted.sum() / self.unit.shape[1]
        return strength if error(strength) + bits * lmbda < self.worth * error(None) else None

    def _rendered(self, search: TextureSearch, texture: TextureSymbols) -> F32:
        return rendered_over(search, self.unit, texture, self.device)


def rendered_over(search: TextureSearch, unit: F32, texture: TextureSymbols, device: Device) -> F32:
    """What a layer over the seeds of `search` shows of `unit` [C, H, W], before restoration."""
    rendered: F32 = unit - search.residual + texture.draw(device)
    return rendered


def _bands(height: int, width: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Rows to look at, and which of them count: bands with a margin, evenly apart, or all of a small tile."""
    count = -(-_LOOKED_AT // (width * _BAND))
    if count * (_BAND + 2 * _MARGIN) >= height:
        return np.arange(height), np.ones(height, bool)
    places = (np.arange(count) * 2 + 1) * height // (2 * count)
    around = np.arange(-_MARGIN, _BAND + _MARGIN) - _BAND // 2
    counted = (around >= -(_BAND // 2)) & (around < _BAND // 2)
    return (places[:, None] + around).ravel(), np.tile(counted, count)


def _least(errors: list[float]) -> int:
    """Where a parabola through the least of the errors at _OFFSETS and those beside it is lowest."""
    best = int(np.argmin(errors))
    if not 0 < best < len(errors) - 1:
        return _OFFSETS[best]
    before, here, after = errors[best - 1 : best + 2]
    curvature = before - 2.0 * here + after
    return _OFFSETS[best] + (round(_APART / 2 * (before - after) / curvature) if curvature > 0 else 0)
