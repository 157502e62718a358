"""Streams of one picture: empty, with and without metadata, and measured by what was asked for."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.state import Tile, tile_of
from sgicodec.encoder.tile.writing import measured, stream_of, write_nothing
from sgicodec.picture import Metadata, Picture
from sgicodec.rate_control.target import RateTarget


def empty_tile(**settings: Any) -> Tile:
    """Of a picture that is transparent everywhere."""
    pixels = np.full((32, 48, 4), 128, np.uint8)
    pixels[..., 3] = 0
    picture = Picture(pixels, "rgba", (0.0, 255.0), metadata=Metadata(icc=b"12345", xmp=b"123"))
    return tile_of(picture, stream_plan(Shape.of(picture), EncodeSettings(effort=1, tile=0, **settings)))


def test_nothing_is_a_stream_that_decodes() -> None:
    tile = empty_tile(lmbda=0.5)
    written = write_nothing(tile)
    assert (written.seeds, written.lmbda, written.part_bytes.keys()) == (0, 0.5, {"mask"})
    with open_stream(stream_of(written, tile)) as stream:
        decoded = stream.picture()
    assert decoded.pixels.shape == (32, 48, 4)
    assert not decoded.pixels[..., 3].any()


@pytest.mark.parametrize("target", [RateTarget(bytes=99), RateTarget(psnr=30.0), RateTarget(score=50.0)])
def test_what_is_asked_for_is_measured(target: RateTarget) -> None:
    tile = empty_tile()
    written = write_nothing(tile)
    found = measured(written, tile, target)
    assert found.bytes == len(stream_of(written, tile))
    assert math.isinf(found.psnr)
    assert math.isnan(found.score) == (target.score is None)
    whole = measured(written, replace(tile, empty=None), target)
    assert math.isfinite(whole.psnr) == (target.psnr is not None)
