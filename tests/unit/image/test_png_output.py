"""PNG files against libpng as imagecodecs has it."""

from __future__ import annotations

from pathlib import Path

import imagecodecs
import numpy as np
import pytest
from image_files import noise, packed
from scenes import ISAS

from sgicodec._native import png_filter
from sgicodec.image import png_output
from sgicodec.image.sink import open_sink
from sgicodec.metadata.layouts import LAYOUTS
from sgicodec.picture import Picture, full_range


def pixels_of(data: bytes) -> np.ndarray:
    """[H, W, C] of a file with nothing behind its end."""
    assert data.endswith(b"\0\0\0\0IEND\xaeB\x60\x82")
    return np.atleast_3d(imagecodecs.png_decode(data))


def smooth(height: int, width: int, count: int) -> np.ndarray:
    y, x, c = np.mgrid[:height, :width, :count]
    return (128 + 90 * np.sin(x / 9 + c) * np.cos(y / 7)).astype(np.uint8)


def written(pixels: np.ndarray, layout: str, **options: int) -> bytes:
    return packed(Picture(pixels, layout, full_range(pixels.dtype)), "png", **options)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
@pytest.mark.parametrize(("height", "width"), [(1, 1), (2, 3), (37, 20)])
def test_another_reader_sees_the_samples(layout: str, dtype: str, height: int, width: int) -> None:
    pixels = noise(height, width, LAYOUTS[layout], dtype)
    np.testing.assert_array_equal(pixels_of(written(pixels, layout)), pixels)


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("band", [1, 7, 30, 100])
def test_same_bytes_however_rows_come(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, threads: int, band: int) -> None:
    """In strips of eleven rows, the last one of one row."""
    pixels = smooth(100, 30, 3)
    monkeypatch.setattr(png_output, "_STRIP_BYTES", 11 * 90 + 5)
    expected = written(pixels, "rgb", threads=1)
    assert expected.count(b"IDAT") == 10
    np.testing.assert_array_equal(pixels_of(expected), pixels)
    with open_sink(tmp_path / "x.png", 30, 100, "rgb", "uint8", threads=threads) as sink:
        for y in range(0, 100, band):
            rows = pixels[y : y + band].copy()
            sink.write_rows(y, rows)
            rows[:] = 0  # whoever wrote them may use their memory again
    assert (tmp_path / "x.png").read_bytes() == expected


@pytest.mark.parametrize("step", [1, 3, 8])
def test_instruction_sets_filter_alike(step: int) -> None:
    rows = np.random.default_rng(step).integers(0, 256, (40, 331 * step), np.uint8)
    rows[10:20] = np.arange(331 * step, dtype=np.uint8)
    found = []
    for isa in ISAS:
        out = np.empty((40, 1 + 331 * step), np.uint8)
        png_filter(rows, np.zeros(331 * step, np.uint8), step, out, isa)
        found.append(out)
    for other in found[1:]:
        np.testing.assert_array_equal(other, found[0])
