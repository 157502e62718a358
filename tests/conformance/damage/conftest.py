"""A small stream of each profile and the picture that each one holds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from data_files import crop

from sgicodec import EncodeSettings, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.picture import Metadata

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
    picture = replace(crop("kodim23", np.s_[180:244, 100:196]), metadata=Metadata(xmp=b"<x:xmpmeta/>"))
    data = encode_picture(picture, SETTINGS[request.param]).data
    with open_stream(data) as stream:
        return Coded(data, stream.picture().pixels)
