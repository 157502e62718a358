"""What tests of several parts share."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clock import Clock

from sgicodec import EncodeSettings, read, write

DATA = Path(__file__).parent / "data"


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """What time.monotonic shows; it stands still unless the test turns it."""
    mine = Clock()
    monkeypatch.setattr(time, "monotonic", mine)
    return mine


@pytest.fixture(scope="session")
def settings() -> EncodeSettings:
    """Short fits of small tiles, and an overview."""
    return EncodeSettings(steps=8, tile=64, overview=True)


@pytest.fixture(scope="session")
def photo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of 150×100 pixels of a photograph: six small tiles."""
    picture = read(DATA / "kodim23.png")
    path = tmp_path_factory.mktemp("photo") / "photo.png"
    write(replace(picture, pixels=np.ascontiguousarray(picture.pixels[180:280, 100:250])), path)
    return path
