"""A small stream of each profile and the picture that each one holds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.picture import Metadata

DATA = Path(__file__).parents[2] / "data"

SETTINGS = {
    "default": EncodeSettings(steps=20),
    "paper": EncodeSettings(profile="paper", steps=20, seeds=40, per_seed=2, features=8),
}


@dataclass(frozen=True)
class Coded:
    """A stream and its samples [H, W, C]."""

    data: bytes
    pixels: np.ndarray


@pytest.fixture(scope="session", params=list(SETTINGS))
def coded(request: pytest.FixtureRequest) -> Coded:
    """96×64 pixels of a photograph, with metadata."""
    picture = read(DATA / "kodim23.png")
    crop = np.ascontiguousarray(picture.pixels[180:244, 100:196])
    picture = replace(picture, pixels=crop, metadata=Metadata(icc=None, exif=None, xmp=b"<x:xmpmeta/>"))
    data = encode_picture(picture, SETTINGS[request.param]).data
    with open_stream(data) as stream:
        return Coded(data, stream.picture().pixels)
