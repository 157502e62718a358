"""PNG files against a reader written from the standard's pages: zlib, filters, nothing else."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from image_files import noise, packed
from scenes import ISAS

from sgicodec._native import png_filter
from sgicodec.image import png_output
from sgicodec.image.sink import open_sink
from sgicodec.metadata.layouts import LAYOUTS
from sgicodec.picture import Picture, full_range


def chunks_of(data: bytes) -> list[tuple[bytes, bytes]]:
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    found, at = [], 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, contents = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + contents)
        found.append((kind, contents))
        at += 12 + length
    return found


def unfiltered(data: bytes, height: int, row_bytes: int, step: int) -> np.ndarray:
    """PNG 3, 9.2, one byte after the other."""
    rows = [[0] * row_bytes]
    for y in range(height):
        kind, *line = data[y * (row_bytes + 1) : (y + 1) * (row_bytes + 1)]
        for i in range(row_bytes):
            left, up, corner = (line[i - step], rows[-1][i], rows[-1][i - step]) if i >= step else (0, rows[-1][i], 0)
            guess = left + up - corner
            nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[kind]) % 256
        rows.append(line)
    return np.array(rows[1:], np.uint8)


def pixels_of(data: bytes) -> np.ndarray:
    found = chunks_of(data)
    assert (found[0][0], found[-1]) == (b"IHDR", (b"IEND", b""))
    width, height, depth, colour, *rest = struct.unpack(">IIBBBBB", found[0][1])
    assert rest == [0, 0, 0]
    step = {0: 1, 2: 3, 4: 2, 6: 4}[colour] * depth // 8
    whole = zlib.decompress(b"".join(contents for kind, contents in found if kind == b"IDAT"))
    rows = unfiltered(whole, height, width * step, step)
    return rows.view(">u2" if depth == 16 else np.uint8).reshape(height, width, -1)


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
    assert len([kind for kind, _ in chunks_of(expected) if kind == b"IDAT"]) == 10
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
