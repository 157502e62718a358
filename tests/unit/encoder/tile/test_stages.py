"""Stages make the next state and change none: the same again gives the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import crop

from sgicodec import EncodeSettings
from sgicodec.encoder.effort import Tune
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.tile.stages import encode, fit, fit_seeds, prepare, rdoq, share, texture
from sgicodec.encoder.tile.state import Tile, tile_of
from sgicodec.encoder.tile.writing import write


def tile_for(tune: Tune) -> Tile:
    """96×80 pixels, with all that an effort may do."""
    picture = crop("kodim13", np.s_[300:380, 80:176])
    tile = tile_of(picture, stream_plan(Shape.of(picture), EncodeSettings(steps=60, tune=tune, metadata=False)))
    return replace(tile, effort=replace(tile.effort, ascent_passes=0 if tune == "psnr" else 2))


@pytest.mark.parametrize("tune", ["psnr", "visual"])
def test_the_same_again(tune: Tune) -> None:
    tile = tile_for(tune)
    prepared = share(prepare(tile))
    fitted = fit(prepared)
    searched = rdoq(fitted)
    shown = texture(searched)
    assert shown.model.texture is not None
    expected = write(shown).payload
    assert write(texture(searched)).payload == expected
    assert write(texture(rdoq(fitted))).payload == expected
    assert write(encode(tile)).payload == expected


def test_what_a_search_learns_stays_with_it() -> None:
    """An ascent moves what its own search looks for, and the offsets of the state that it returns."""
    tile = tile_for("visual")
    state, _ = fit_seeds(tile).begin_texture()
    before = state.step_offsets.copy()
    texture(state)
    np.testing.assert_array_equal(state.step_offsets, before)
