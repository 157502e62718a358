"""A small picture, its stream, and what that shows."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop

import sgicodec


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    """A piece of a photograph [64, 96, 3]."""
    return crop("kodim23", np.s_[200:264, 100:196]).pixels


@pytest.fixture(scope="module")
def data(pixels: np.ndarray) -> bytes:
    """Its stream, of four tiles."""
    return sgicodec.encode(pixels, quality=60, steps=20, tile=48)


@pytest.fixture(scope="module")
def whole(data: bytes) -> np.ndarray:
    """What it decodes to."""
    return sgicodec.decode(data)
