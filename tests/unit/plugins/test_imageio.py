"""Streams in imageio, beside the pictures of Silicon Graphics."""

from __future__ import annotations

from pathlib import Path

import imageio.v3 as iio
import numpy as np
import pytest
from data_files import GOLDEN, PICTURES

import sgicodec
import sgicodec.plugins.imageio
from sgicodec.errors import RegionError, UsageError


@pytest.mark.parametrize("name", ["rgb8", "gray16", "float", "rgba8", "multi8"])
def test_reading(name: str) -> None:
    path = GOLDEN / f"{name}.sgi"
    expected = sgicodec.imread(path)
    np.testing.assert_array_equal(iio.imread(path), expected)
    np.testing.assert_array_equal(iio.imread(path.read_bytes(), extension=".sgi"), expected)
    properties = iio.improps(path)
    assert (properties.shape, properties.dtype) == (expected.shape, expected.dtype)
    np.testing.assert_array_equal(iio.imread(path, index=...), expected[None])
    assert [image.shape for image in iio.imiter(path)] == [expected.shape]


def test_writing(tmp_path: Path) -> None:
    pixels = np.random.default_rng(3).integers(0, 256, (24, 32, 3), np.uint8)
    iio.imwrite(tmp_path / "a.sgi", pixels, plugin="sgicodec", quality=80, steps=4)
    assert (tmp_path / "a.sgi").read_bytes() == sgicodec.encode(pixels, quality=80, steps=4)
    data = iio.imwrite("<bytes>", pixels, plugin="sgicodec", extension=".sgi", quality=80, steps=4)
    assert data == sgicodec.encode(pixels, quality=80, steps=4)
    with pytest.raises(UsageError, match="2 images"):
        iio.imwrite(tmp_path / "b.sgi", [pixels, pixels], plugin="sgicodec")


def test_metadata() -> None:
    found = iio.immeta(GOLDEN / "rgb8.sgi", plugin="sgicodec")
    assert found == {"channels": "rgb"}


def test_what_goes_wrong() -> None:
    with pytest.raises(RegionError, match="image 1; a stream holds one"):
        iio.imread(GOLDEN / "rgb8.sgi", index=1)
    with pytest.raises(OSError, match="can not handle"):
        iio.imread(PICTURES / "hopper.sgi", plugin="sgicodec")
