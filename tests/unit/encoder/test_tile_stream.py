"""Streams of one picture: empty, with and without metadata, and measured by what was asked for."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sgicodec.decoder.stream import open_stream
from sgicodec.device import ALL_CORES
from sgicodec.encoder.nodata import Bare
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile_stream import TileStream
from sgicodec.picture import Metadata, Picture


def stream_of(empty: np.ndarray | None = None, **settings: Any) -> TileStream:
    pixels = np.full((32, 48, 4), 128, np.uint8)
    pixels[..., 3] = 0 if empty is not None else 255
    picture = Picture(pixels, "rgba", (0.0, 255.0), metadata=Metadata(icc=b"12345", xmp=b"123"))
    plan = stream_plan(Shape.of(picture), EncodeSettings(effort=1, tile=0, **settings))
    return TileStream(picture, plan, empty, Bare(None, None), ALL_CORES)


def test_nothing_is_a_stream_that_decodes() -> None:
    encoded = stream_of(np.ones((32, 48), bool)).nothing(0.5)
    assert (encoded.seeds, encoded.lmbda) == (0, 0.5)
    with open_stream(encoded.data) as stream:
        decoded = stream.picture()
    assert decoded.pixels.shape == (32, 48, 4)
    assert not decoded.pixels[..., 3].any()


@pytest.mark.parametrize(("kept", "size"), [(True, 8), (False, 0)])
def test_bytes_of_metadata(kept: bool, size: int) -> None:
    assert stream_of(metadata=kept).blob_bytes == size


@pytest.mark.parametrize("asked", [{}, {"psnr": 30.0}, {"ssimulacra2": 50.0}])
def test_what_is_asked_for_is_measured(asked: dict[str, float]) -> None:
    stream = stream_of(np.ones((32, 48), bool), **asked)
    found = stream.measured(stream.nothing(0.5))
    assert found.bytes == len(stream.nothing(0.5).data)
    assert math.isinf(found.psnr)
    assert math.isnan(found.score) == ("ssimulacra2" not in asked)
    whole = replace(stream, empty=None).measured(stream.nothing(0.5))
    assert math.isfinite(whole.psnr) == ("psnr" in asked)
