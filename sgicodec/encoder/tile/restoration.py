"""How a tile is restored: with the strength that brings what is rendered nearest to the picture, or not at all; towards
least squared error with a last layer of the network that is fitted to the tile.

What the layer adds up to is linear in its weights, so that squared error is a quadratic form of what is added to them
(docs/format.md, "Restoration"). Integers of least cost are found one after the other, round by round.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from sgicodec._native import restoration_last_inputs, restoration_last_layer
from sgicodec.bitstream.entropy.tables import SCALES, TABLES, frequency_tables
from sgicodec.device import Device
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.restoration import Restoration
from sgicodec.model.texture_symbols import STEP_COUNT, TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["Restorer", "Strength", "adapted", "rendered_over"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

_LAYERS, _TAPS = 4, 9
_INPUT_UNIT = 128.0
"""In which inputs and sums are added up here, so that single precision serves."""
_BIAS = 64.0 / _INPUT_UNIT
_STRIP, _PIXELS = 1 << 15, 1 << 18
"""Pixels that are looked at together; about as many are looked at in all, at odd distances."""
_UNITS = (8, 16)
"""In which changes are tried."""
_ROUNDS, _MAX_CHANGE = 12, 100
"""Of a search; the largest change in units."""
_FIRST_TABLE = SCALES + 18
"""Of a Laplace distribution with a deviation of half a unit."""
_MAX_SUM = 1 << 16
"""Of an output's weights, so that sums fit."""
_TABLE_BITS, _PART_BITS = (TABLES - 1).bit_length(), 12
"""Of an output; of the part, for units."""


@dataclass(frozen=True)
class _Form:
    """By how much changes w [outputs, n] lower squared error: 2 moments · w − w · gram · w, for each output. unit: of
    samples in which that is.
    """

    gram: F64
    moments: F64
    unit: float


def adapted(
    restoration: Restoration, rendered: F32, wanted: F32, empty: NDArray[np.bool_] | None, lmbda: float, device: Device
) -> Restoration:
    """Restoration of a shipped network, with a last layer that brings what is rendered [C, H, W] nearer to what is
    wanted; as it is where that is not worth its bits. empty [H, W]: pixels that count nothing, None for none; lmbda:
    squared error in samples that a bit must save.
    """
    form = _form(restoration, rendered, wanted, empty, device)
    price = lmbda / form.unit**2
    options = [(unit, *_searched(unit**2 * form.gram, unit * form.moments, price)) for unit in _UNITS]
    unit, change, gain = max(options, key=lambda option: option[2])
    layer, _ = restoration_last_layer(restoration.network)
    whole = np.zeros_like(layer)
    whole[: len(change)] = unit * change
    if gain <= price * _PART_BITS or np.abs(layer + whole).sum(axis=1).max() >= _MAX_SUM:
        return restoration
    return replace(restoration, changes=(*(np.zeros((0, 0), np.int32),) * (_LAYERS - 1), whole))


def _form(
    restoration: Restoration, rendered: F32, wanted: F32, empty: NDArray[np.bool_] | None, device: Device
) -> _Form:
    number, step = restoration.network, restoration.step
    weights, shift = restoration_last_layer(number)
    outputs = 3 if len(rendered) >= 3 else 1
    unit = 2.0 ** ((step - 480) / 32 - shift) * _INPUT_UNIT
    into = np.array(colour_matrix(outputs), np.float32) / np.float32(unit)
    last = weights[:outputs].astype(np.float32)
    gram, moments = np.zeros((last.shape[1],) * 2), np.zeros(last.shape)
    height, width = rendered.shape[1:]
    every, rows = -(-height * width // _PIXELS) | 1, max(1, _STRIP // width)
    for top in range(0, height, rows):
        part = slice(top, min(top + rows, height))
        seen = restoration_last_inputs(rendered, number, step, top, part.stop - top, device.threads, device.isa)
        looked = (np.arange(width) + 2 * np.arange(part.start, part.stop)[:, None]) % every == 0
        if empty is not None:
            looked &= ~empty[part]
        inputs = _windows(seen, looked)
        left = np.tensordot(into, (wanted[:outputs, part] - rendered[:outputs, part])[:, looked], 1)
        gram += inputs @ inputs.T
        moments += (left - last @ inputs) @ inputs.T
    return _Form(every * gram, every * moments, unit)


def _windows(seen: NDArray[np.int16], looked: NDArray[np.bool_]) -> F32:
    """What weights of an output are multiplied with at these pixels [n, pixels]; last, what its bias is."""
    windows = sliding_window_view(seen, (3, 3), axis=(1, 2))  # [channels, rows, columns, 3, 3]
    taps = np.stack([windows[:, looked, i, j] for i in range(3) for j in range(3)], axis=1)
    rows = np.empty((_TAPS * len(seen) + 1, taps.shape[2]), np.float32)
    np.multiply(taps, np.float32(1.0 / _INPUT_UNIT), out=rows[:-1].reshape(taps.shape))
    rows[-1] = _BIAS
    return rows


def _searched(gram: F64, moments: F64, price: float) -> tuple[I32, float]:
    """Integers [outputs, n] that lower squared error by more than `price` for each of their bits, and by how much."""
    coding, values = frequency_tables(), np.arange(-_MAX_CHANGE, _MAX_CHANGE + 1)
    tables = np.full(len(moments), _FIRST_TABLE)
    change, best, most = np.zeros(moments.shape, np.int64), np.zeros(moments.shape, np.int64), 0.0
    slopes = moments.copy()
    for _ in range(_ROUNDS):
        prices = price * coding.bits(values, tables[:, None])
        if not _descend(gram, prices, change, slopes):
            break
        tables = np.array([coding.best(own) for own in change])
        bits = coding.bits(change, tables[:, None]).sum() + _TABLE_BITS * len(change)
        gain = float(((moments + slopes) * change).sum() - price * bits)
        if gain > most:
            best, most = change.copy(), gain
    return best.astype(np.int32), most


def _descend(gram: F64, prices: F64, change: I64, slopes: F64) -> bool:
    """Makes each number the best one as the others are; whether any changed. prices [outputs, values] of −_MAX_CHANGE …
    _MAX_CHANGE; slopes: what is left of the moments, which is kept up to date.
    """
    outputs, moves = np.arange(len(change)), False
    for i, curvature in enumerate(np.maximum(gram.diagonal(), np.finfo(np.float64).tiny)):
        least = np.clip(change[:, i] + slopes[:, i] / curvature, -_MAX_CHANGE, _MAX_CHANGE - 1)
        low = np.floor(least).astype(np.int64)
        options = np.stack([np.zeros_like(low), low, low + 1])
        costs = curvature * np.square(options - least) + prices[outputs, options + _MAX_CHANGE]
        chosen = options[np.argmin(costs, axis=0), outputs]
        moved = chosen - change[:, i]
        if moved.any():
            slopes -= moved[:, None] * gram[i]
            change[:, i] = chosen
            moves = True
    return moves


_OFFSETS, _APART = (-40, -24, -8, 8), 16
"""Steps that are tried, from texture's own, in 32nds of an octave."""
_STRONGER = {1: 0, 3: 4}
"""By network, how far above the step of least squared error it does best."""
_LARGER = {1: 1.0, 3: 1.02}
"""By network, what squared error may grow by: the one for the eye gains by what squared error does not tell."""
_BITS = 21
"""That a stream takes for it: the part, and a byte of the header."""
_LOOKED_AT, _BAND, _MARGIN = 1 << 17, 64, 4
"""Pixels that strengths are compared on, in bands of so many rows; rows at their edges that depend on what lies beyond.
"""


@dataclass(frozen=True)
class Strength:
    """A network, how far its step is above texture's (the larger the step, the more it takes away), and what is added
    to its layers.
    """

    network: int
    offset: int
    changes: tuple[NDArray[np.int32], ...] = ()

    def over(self, texture: TextureSymbols) -> Restoration:
        """Restoration of what is rendered with a layer."""
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

        least = _least([error(Strength(self.network, offset)) for offset in _OFFSETS])
        strength = Strength(self.network, least + _STRONGER[self.network])
        bits = _BITS * counted.sum() / self.unit.shape[1]
        return strength if error(strength) + bits * lmbda < _LARGER[self.network] * error(None) else None

    def adapted(self, search: TextureSearch, texture: TextureSymbols, strength: Strength, lmbda: float) -> Strength:
        """The same with a last layer that suits what a layer over the seeds of `search` shows."""
        rendered = self._rendered(search, texture)
        restoration = adapted(strength.over(texture), rendered, self.unit, self.empty, lmbda, self.device)
        return replace(strength, changes=restoration.changes)

    def _rendered(self, search: TextureSearch, texture: TextureSymbols) -> F32:
        return rendered_over(search, self.unit, texture, self.device)


def rendered_over(search: TextureSearch, unit: F32, texture: TextureSymbols, device: Device) -> F32:
    """What a layer over the seeds of `search` shows of `unit` [C, H, W], before restoration."""
    rendered: F32 = unit - search.residual + texture.layer().draw(device=device)
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
