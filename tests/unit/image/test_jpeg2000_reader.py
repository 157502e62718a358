"""JPEG 2000 that OpenImageIO does not read rightly: signed samples, and more than 16 bits."""

from __future__ import annotations

from pathlib import Path

import imagecodecs
import numpy as np
import pytest

from sgicodec import open_source, read
from sgicodec.errors import PictureError

CASES = [("int8", 8, 1), ("int16", 16, 1), ("int16", 12, 1), ("int16", 12, 3), ("int16", 10, 4), ("uint32", 20, 1)]


def numbers(dtype: str, bits: int, bands: int) -> np.ndarray:
    low, high = (0, 1 << bits) if dtype.startswith("u") else (-(1 << bits - 1), 1 << bits - 1)
    found = np.random.default_rng(bits).integers(low, high, (40, 50, bands)).astype(dtype)
    return found if bands > 1 else found[..., 0]


@pytest.mark.parametrize(("dtype", "bits", "bands"), CASES)
@pytest.mark.parametrize("container", ["jp2", "j2k"])
def test_the_numbers_are_those_of_the_file(tmp_path: Path, dtype: str, bits: int, bands: int, container: str) -> None:
    stored = numbers(dtype, bits, bands)
    data = imagecodecs.jpeg2k_encode(stored, codecformat=container, reversible=True, bitspersample=bits)
    (tmp_path / "x.jp2").write_bytes(data)
    picture = read(tmp_path / "x.jp2")
    assert picture.channels == {1: "gray", 3: "rgb"}.get(bands, "multi")
    assert picture.pixels.dtype == np.float32
    np.testing.assert_array_equal(picture.pixels, stored.reshape(40, 50, -1))
    with open_source(tmp_path / "x.jp2") as source:
        np.testing.assert_array_equal(source.read(7, 5, 30, 20).pixels, picture.pixels[5:25, 7:37])


def test_what_has_more_bits_than_floats_is_off(tmp_path: Path) -> None:
    stored = (1 << 24 | numbers("uint32", 10, 1) | 1).astype(np.uint32)
    data = imagecodecs.jpeg2k_encode(stored, codecformat="jp2", reversible=True, bitspersample=25)
    (tmp_path / "x.jp2").write_bytes(data)
    with open_source(tmp_path / "x.jp2") as source:
        picture = source.read(0, 0, 50, 40)
        assert "samples of uint32 become 32-bit floats, rounded to 24 bits" in source.notes
    np.testing.assert_array_equal(picture.pixels[..., 0], stored.astype(np.float32))
    assert read(tmp_path / "x.jp2").rounding == 1


@pytest.mark.parametrize("bits", [8, 12, 16])
@pytest.mark.parametrize("bands", [2, 5])
@pytest.mark.parametrize("container", ["jp2", "j2k"])
def test_bands_that_nothing_says_of(bits: int, bands: int, container: str) -> None:
    """Not gray and alpha, and not of eight bits, which Pillow would make of two."""
    dtype = np.uint8 if bits == 8 else np.uint16
    stored = np.random.default_rng(bits).integers(0, 1 << bits, (40, 50, bands)).astype(dtype)
    picture = read(bytes(imagecodecs.jpeg2k_encode(stored, codecformat=container, reversible=True, bitspersample=bits)))
    assert (picture.channels, picture.pixels.dtype) == ("multi", dtype)
    np.testing.assert_array_equal(picture.pixels, stored)


@pytest.mark.parametrize("side", [0, 1 << 31, 0xFFFFFFFF])
def test_sizes_of_no_picture_are_refused(side: int) -> None:
    data = bytearray(imagecodecs.jpeg2k_encode(numbers("int16", 12, 3)[..., :2], codecformat="j2k", reversible=True))
    data[8:12] = side.to_bytes(4, "big")
    with pytest.raises(PictureError):
        read(bytes(data))


def test_damage_is_refused() -> None:
    data = bytes(imagecodecs.jpeg2k_encode(numbers("int16", 16, 1), codecformat="jp2", reversible=True))
    with pytest.raises(PictureError):
        read(data[: len(data) // 2])
