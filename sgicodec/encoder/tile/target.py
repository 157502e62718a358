"""The only tile of a stream on its way to a size, a PSNR or a score: seeds are fitted once or twice, then the step of
texture moves.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from sgicodec.encoder.tile.restoration import Strength
from sgicodec.encoder.tile.stages import STRATEGIES, fit_seeds, prepare, rd_model
from sgicodec.encoder.tile.state import Tile, TileState
from sgicodec.encoder.tile.writing import EncodedTile, measured, network_weights, write
from sgicodec.model.texture_symbols import STEP_COUNT
from sgicodec.rate_control.rd_model import initial_lmbda, network_bytes
from sgicodec.rate_control.step_search import OCTAVES_PER_UNIT, SHIFT_MAX, step_shift
from sgicodec.rate_control.target import LMBDA_MAX, LMBDA_MIN, Measured, RateTarget

__all__ = ["write_at_target"]

MAX_FITS = 2
FAR_OCTAVES = 1.5
"""Octaves of λ between seeds and texture from which on another fit is worth its time; two octaves cost 0.1 dB
(docs/notes/2026-11-texture.md)."""


def write_at_target(tile: Tile, target: RateTarget) -> tuple[EncodedTile, str | None]:
    """The tile that comes nearest to the target, and how it misses that, if it does."""
    best = _nearest(tile, target)
    return best.encoded, target.miss_message(best.measured) if target.is_missed(best.measured) else None


class _Tried(NamedTuple):
    encoded: EncodedTile
    measured: Measured


def _nearest(tile: Tile, target: RateTarget) -> _Tried:
    """The nearest of as many fits as it takes. λ of the seeds is what the R-D model predicts; the step of texture does
    the rest, and where it would have to go far, seeds are fitted once more.
    """
    lmbda, strength = initial_lmbda(target, rd_model(prepare(tile, tile.fit.lmbda)), _extra_bytes(tile)), None
    if target.bytes is not None:
        lmbda = min(lmbda * 2.0**tile.tuning.larger, LMBDA_MAX)
    tried: list[_Tried] = []
    for _ in range(MAX_FITS):
        # Without two passes, the seeds of a fit that was ended early may take more than the whole stream is to have.
        state = fit_seeds(tile, lmbda, min_passes=2)
        stream, octaves, strength = _at_target(replace(state, strength=strength), target)
        tried.append(stream)
        lmbda = min(max(lmbda * 2.0**octaves, LMBDA_MIN), LMBDA_MAX)
        if tile.watch.was_ended or (target.is_met(stream.measured) and abs(octaves) < FAR_OCTAVES):
            break
    return tried[target.best([one.measured for one in tried])]


def _extra_bytes(tile: Tile) -> float:
    """Bytes of metadata and of networks that travel in the stream."""
    metadata = tile.plan.metadata
    blobs = () if metadata is None else (metadata.icc, metadata.exif, metadata.xmp)
    return sum(len(blob) for blob in blobs if blob) + network_bytes(network_weights(tile.spec))


def _at_target(state: TileState, target: RateTarget) -> tuple[_Tried, float, Strength | None]:
    """The best stream with these seeds, by how many octaves their λ should have been larger, and with which strength
    texture was restored, which the next fit begins with.
    """
    tile = state.tile
    strategy, first = STRATEGIES[tile.settings.tuned_for], tile.tuning.step(state.lmbda)
    tile.watch.stage("texture")
    state, search = state.begin_texture()
    tried: dict[float, _Tried] = {}
    none_from = math.inf  # the shift from which on there is no texture

    def step_at(shift: float) -> int:
        return min(max(first + math.floor(shift), 0), STEP_COUNT - 1)

    def measure(shift: float) -> Measured:
        nonlocal none_from
        if shift in tried:
            return tried[shift].measured
        if shift > none_from:
            tried[shift] = tried[none_from]
            return tried[shift].measured
        price = tile.tuning.squared_steps * 2.0 ** (-OCTAVES_PER_UNIT * (shift % 1))
        textured = strategy.lay_at(state, search, step_at(shift), price)
        if textured.model.texture is None:
            none_from = shift
        encoded = write(textured)
        tried[shift] = _Tried(encoded, measured(encoded, tile, target))
        return tried[shift].measured

    # What follows is for the texture about where the target will be met.
    near = round(min(max(target.rate_error(measure(0.0)) / -OCTAVES_PER_UNIT, -SHIFT_MAX), SHIFT_MAX))
    before, (state, search) = state, strategy.aim(state, search, step_at(near))
    if state is not before:
        none_from = math.inf
        tried.clear()
    shift = near + step_shift(target, lambda moved: measure(near + moved))
    octaves = -OCTAVES_PER_UNIT * shift
    if not target.is_met(tried[shift].measured):
        octaves += target.rate_error(tried[shift].measured)
    return tried[shift], octaves, state.strength
