"""A photograph of six small tiles, on disk."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, read
from sgicodec.image import write

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture(scope="session")
def settings() -> EncodeSettings:
    """Short fits of small tiles, and an overview."""
    return EncodeSettings(steps=8, tile=64, overview=True, threads=1)


@pytest.fixture(scope="session")
def photo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """150×100 pixels."""
    picture = read(DATA / "kodim23.png")
    path = tmp_path_factory.mktemp("photo") / "photo.png"
    write(replace(picture, pixels=np.ascontiguousarray(picture.pixels[180:280, 100:250])), path)
    return path
