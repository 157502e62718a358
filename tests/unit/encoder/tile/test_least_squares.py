"""Seeds that are searched again beside texture: fewer bytes at the same error."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
from data_files import crop

from sgicodec import EncodeSettings
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.effort import Tune
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.tile.least_squares import requantise_seeds_under_texture, with_seeds_for
from sgicodec.encoder.tile.stages import fit_seeds, texture
from sgicodec.encoder.tile.state import TileState, Watch, tile_of
from sgicodec.encoder.tile.writing import stream_of, write
from sgicodec.metrics.distortion import squared_error

STEPS = 600


@cache
def searched(tune: Tune, quality: float = 54) -> TileState:
    """256×192 pixels of a parrot, after fit and RDOQ."""
    picture = crop("kodim23", np.s_[100:292, 200:456])
    settings = EncodeSettings(quality=quality, steps=STEPS, tune=tune, metadata=False)
    tile = tile_of(picture, stream_plan(Shape.of(picture), settings))
    return fit_seeds(tile, tile.fit.lmbda)


def cost(state: TileState) -> tuple[int, float]:
    """Bytes and squared error of these seeds with texture."""
    written = write(texture(state))
    with open_stream(stream_of(written, state.tile)) as stream:
        return len(written.payload), squared_error(state.tile.picture, stream.picture())


def requantised(state: TileState, rounds: int) -> TileState:
    tile = replace(state.tile, effort=replace(state.tile.effort, rounds=rounds))
    return requantise_seeds_under_texture(replace(state, tile=tile))


def test_the_same_error_takes_fewer_bytes() -> None:
    """By the slope that two qualities have."""
    state = searched("psnr", 60)
    size, error = cost(state)
    less, more = cost(searched("psnr"))
    octaves = math.log(size / less) / math.log(more / error)
    for rounds in (2, 3):
        found, left = cost(requantised(state, rounds))
        assert math.log(found / size) < octaves * math.log(error / left) - 0.005


def test_none_without_a_search_or_texture() -> None:
    state = searched("psnr")
    for settings in ({"rdoq": False}, {"texture": False}):
        asked = replace(state.tile.settings, **settings)
        tile = tile_of(state.tile.picture, stream_plan(Shape.of(state.tile.picture), asked))
        assert requantised(replace(state, tile=tile), 3).model is state.model


def test_an_encode_that_is_to_end_requantises_no_more() -> None:
    state = searched("psnr")
    tile = replace(state.tile, watch=Watch(state.tile.watch.listener, was_ended=True))
    assert requantised(replace(state, tile=tile), 3).model is state.model


def test_steps_of_seeds_stay() -> None:
    """Only symbols move: as many seeds, where they were, under the same context model."""
    state = searched("psnr")
    unit = state.tile.unit
    found = with_seeds_for(state, unit - unit.mean(axis=(1, 2), keepdims=True)).model
    assert found.layout is state.model.layout
    assert found.networks is state.model.networks
