"""A small picture, its stream, and what that shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import sgicodec

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    """A piece of a photograph [64, 96, 3]."""
    return np.asarray(Image.open(PHOTO))[200:264, 100:196]


@pytest.fixture(scope="module")
def data(pixels: np.ndarray) -> bytes:
    """Its stream, of four tiles."""
    return sgicodec.encode(pixels, quality=60, steps=20, tile=48)


@pytest.fixture(scope="module")
def whole(data: bytes) -> np.ndarray:
    """What it decodes to."""
    return sgicodec.decode(data)
