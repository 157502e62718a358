from __future__ import annotations

import io
import itertools
import struct
from pathlib import Path
from typing import Any
from unittest.mock import create_autospec

import numpy as np
import pytest
import tifffile
from examples import examples
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from image_files import noise, save, window_rows
from tags import exif_blob

from sgicodec import open_source, read, write
from sgicodec.errors import PictureError, UsageError
from sgicodec.image import access
from sgicodec.image.opened import Opened
from sgicodec.metadata import ifd
from sgicodec.picture import Metadata, Picture, nodata_mask

WIDTH, HEIGHT = 71, 53
STRIP_OFFSETS, TILE_OFFSETS = 273, 324

STRIPS = {"compression": "zip", "tiff__RowsPerStrip": 8}
KINDS: dict[str, tuple[str, str, int, dict[str, Any]]] = {
    "tiles": ("tif", "uint8", 3, {"tile": (16, 32), "compression": "zip"}),
    "tiles of planes": ("tif", "uint16", 3, {"tile": (32, 16), "compression": "zip", "planarconfig": "separate"}),
    "tiles of alpha": ("tif", "uint8", 4, {"tile": (16, 16)}),
    "tiles of integers": ("tif", "int16", 5, {"tile": (16, 16), "compression": "lzw"}),
    "one tile": ("tif", "float32", 1, {"tile": (128, 128)}),
    "strips": ("tif", "uint8", 3, STRIPS),
    "strips of planes": ("tif", "uint16", 4, {"rows": 8}),
    "one strip of planes": ("tif", "uint8", 3, {"rows": 53}),
    "one strip": ("tif", "uint16", 1, {"compression": "lzw", "tiff__RowsPerStrip": 53}),
    "plain strips": ("tif", "float32", 2, {"compression": "none"}),
    "doubles": ("tif", "float64", 2, STRIPS),
    "halves": ("tif", "float16", 3, {**STRIPS, "tiff__half": 1}),
    "four bits": ("tif", "uint8", 1, {**STRIPS, "oiio__BitsPerSample": 4}),
    "placed": ("tif", "uint8", 3, {**STRIPS, "at": (7, 9)}),
    "placed tiles": ("tif", "uint8", 3, {"tile": (16, 16), "at": (16, 32)}),
    "exr window": ("exr", "float16", 3, {"at": (-5, 3)}),
    "png": ("png", "uint8", 3, {}),
    "png with alpha": ("png", "uint16", 4, {}),
    "jpeg": ("jpg", "uint8", 3, {}),
    "progressive jpeg": ("jpg", "uint8", 3, {"jpeg__progressive": 1}),
    "exr": ("exr", "float16", 4, {"compression": "zip"}),
    "exr tiles": ("exr", "float32", 3, {"tile": (16, 16)}),
    "bmp": ("bmp", "uint8", 3, {}),
    "sgi": ("sgi", "uint16", 3, {"compression": "rle"}),
    "targa": ("tga", "uint8", 4, {"compression": "rle"}),
    "hdr": ("hdr", "float32", 3, {}),
    "ppm": ("ppm", "uint8", 3, {}),
    "pfm": ("pfm", "float32", 1, {}),
    "webp": ("webp", "uint8", 4, {"compression": "lossless:50"}),
    "jpeg 2000": ("jp2", "uint8", 3, {}),
    "jpeg xl": ("jxl", "uint8", 3, {"compression": "jpegxl:100"}),
    "gif": ("gif", "uint8", 3, {}),
}

ANY_WINDOWS = st.lists(
    st.tuples(st.integers(0, WIDTH - 1), st.integers(0, HEIGHT - 1), st.integers(1, WIDTH), st.integers(1, HEIGHT)),
    min_size=1,
    max_size=6,
)


def save_planes(path: Path, pixels: np.ndarray, rows: int) -> Path:
    """A TIFF of planes, one after the other in compressed strips of several rows, which OpenImageIO cannot write."""
    options: dict[str, Any] = {"planarconfig": "separate", "compression": "zlib", "rowsperstrip": rows}
    tifffile.imwrite(path, np.moveaxis(pixels, -1, 0), photometric="minisblack", metadata=None, **options)
    return path


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """One file of each kind, of samples whose colours are not larger than their alpha."""
    folder, made = tmp_path_factory.mktemp("files"), {}
    for name, (extension, dtype, count, hints) in KINDS.items():
        largest = 200 if dtype == "uint8" else 100 if np.dtype(dtype).kind == "i" else 40000
        pixels = np.random.default_rng(5).integers(0, largest, (HEIGHT, WIDTH, count)).astype(dtype)
        pixels[..., -1] = np.maximum(pixels[..., -1], 1)
        write_file = save_planes if "rows" in hints else save
        made[name] = write_file(folder / f"{name}.{extension}", pixels, **hints)
    return made


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=examples(25), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(windows=ANY_WINDOWS)
@example(windows=[(0, 44, 1, 4)])
def test_windows_are_parts_of_the_whole(
    files: dict[str, Path], kind: str, windows: list[tuple[int, int, int, int]]
) -> None:
    whole = read(files[kind])
    with open_source(files[kind]) as source:
        assert (source.width, source.height, source.channels) == (whole.width, whole.height, whole.channels)
        assert (source.dtype, source.sample_range) == (whole.pixels.dtype, whole.sample_range)
        assert source.metadata == whole.metadata
        for x, y, width, height in windows:
            width, height = min(width, whole.width - x), min(height, whole.height - y)
            part = source.read(x, y, width, height)
            np.testing.assert_array_equal(part.pixels, whole.pixels[y : y + height, x : x + width])
            assert (part.channels, part.sample_range) == (whole.channels, whole.sample_range)


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["tiles", "strips", "png"])
def test_windows_of_turned_pictures(tmp_path: Path, kind: str, orientation: int) -> None:
    stored = noise(HEIGHT, WIDTH, 3, "uint8")
    path = tmp_path / f"x.{KINDS[kind][0]}"
    if kind == "png":
        write(Picture(stored, "rgb", (0, 255), Metadata(exif=exif_blob(orientation))), path)
    else:
        save(path, stored, **KINDS[kind][3], Orientation=orientation)
    turns = {1: 0, 2: 0, 3: 2, 4: 2, 5: 1, 6: -1, 7: -1, 8: 1}
    upright = np.rot90(stored, turns[orientation])
    if orientation in (2, 4):
        upright = upright[:, ::-1]
    elif orientation in (5, 7):
        upright = upright[::-1]
    with open_source(path) as source:
        assert (source.height, source.width) == upright.shape[:2]
        can_turn = kind == "tiles" or orientation < (3 if kind == "png" else 5)
        assert isinstance(source._access, access.KeptRows) != can_turn
        for x, y in itertools.product(range(0, source.width - 20, 13), range(0, source.height - 17, 11)):
            np.testing.assert_array_equal(source.read(x, y, 20, 17).pixels, upright[y : y + 17, x : x + 20])


@pytest.mark.parametrize("kind", ["strips", "strips of planes", "png", "jpeg", "exr"])
def test_rows_are_decoded_once(files: dict[str, Path], kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    samples = create_autospec(Opened.samples, side_effect=Opened.samples)
    monkeypatch.setattr(access, "_CHUNK_SAMPLES", 900)
    monkeypatch.setattr(Opened, "samples", samples)
    monkeypatch.setattr(Opened, "reopen", lambda _: pytest.fail("went back to the first row"))
    with open_source(files[kind], sample_range=(0.0, 1.0)) as source:
        for window in window_rows(WIDTH, HEIGHT, 16, 4):
            source.read(*window)
    asked = [call.args[2] for call in samples.mock_calls]
    assert sum(asked) == HEIGHT
    assert max(asked) < HEIGHT / 2


@pytest.mark.parametrize("kind", ["jpeg", "strips", "tiles"])
def test_damage_is_found_in_its_window(
    files: dict[str, Path], tmp_path: Path, kind: str, capfd: pytest.CaptureFixture[str]
) -> None:
    data = bytearray(files[kind].read_bytes())
    path = tmp_path / files[kind].name
    if kind == "jpeg":
        del data[len(data) * 3 // 4 :]
    else:  # the last tile or strip begins with what zlib never writes; damage further on may decode to something
        places = ifd.load(bytes(data))[TILE_OFFSETS if kind == "tiles" else STRIP_OFFSETS].data
        last = struct.unpack("<I", places[-4:])[0]
        data[last : last + 2] = b"\xff\xff"
    path.write_bytes(data)
    with open_source(path) as source:
        np.testing.assert_array_equal(source.read(0, 0, WIDTH, 8).pixels, read(files[kind]).pixels[:8])
        for _ in "twice":
            with pytest.raises(PictureError, match=path.name):
                source.read(0, 8, WIDTH, HEIGHT - 8)
        with pytest.raises(PictureError, match=path.name):
            [source.read(0, y, WIDTH, 1) for y in range(8, HEIGHT)]
        np.testing.assert_array_equal(source.read(0, 0, WIDTH, 8).pixels, read(files[kind]).pixels[:8])
    assert capfd.readouterr().err == ""


def test_the_range_of_floats_is_found_in_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = np.linspace(-3.0, 8.0, 60 * 70, dtype=np.float32).reshape(60, 70, 1)
    monkeypatch.setattr("sgicodec.image.source._SCAN_SAMPLES", 500)
    for tile in ((0, 0), (16, 16)):
        path = save(tmp_path / "x.tif", pixels, tile=tile)
        with open_source(path) as source:
            assert source.sample_range == (-3.0, 8.0)
        with open_source(path, sample_range=(0.0, 1.0)) as source:
            assert source.read(0, 0, 1, 1).sample_range == (0.0, 1.0)
    pixels[40, 40] = np.inf
    save(tmp_path / "x.tif", pixels)
    with open_source(tmp_path / "x.tif") as source:
        window = source.read(30, 30, 20, 20)
    assert (window.exact, window.sample_range) == (True, (-3.0, 8.0))
    save(tmp_path / "x.tif", np.full_like(pixels, np.inf))
    with open_source(tmp_path / "x.tif") as source, pytest.raises(PictureError, match=r"x\.tif: .*infinite"):
        source.read(0, 0, 1, 1)


@pytest.mark.parametrize("stated", [(0.0, 1.0), None])
def test_not_a_number_is_nodata_where_nothing_else_is(tmp_path: Path, stated: tuple[float, float] | None) -> None:
    pixels = np.zeros((60, 70, 1), np.float32)
    pixels[40, 40] = np.nan
    with open_source(save(tmp_path / "x.tif", pixels, tile=(16, 16)), sample_range=stated) as source:
        assert np.isnan(source.nodata)
        window = source.read(30, 30, 20, 20)
    assert np.argwhere(nodata_mask(window)).tolist() == [[10, 10]]


def test_paths_bytes_and_streams(files: dict[str, Path]) -> None:
    data = files["tiles"].read_bytes()
    expected = read(data).pixels[5:9, 7:17]
    for origin in (files["tiles"], str(files["tiles"]), data, io.BytesIO(data)):
        with open_source(origin) as source:
            np.testing.assert_array_equal(source.read(7, 5, 10, 4).pixels, expected)


@pytest.mark.parametrize("window", [(-1, 0, 5, 5), (0, 0, 0, 5), (0, 0, 5, 0), (70, 0, 2, 1), (0, 50, 1, 4)])
def test_windows_outside(files: dict[str, Path], window: tuple[int, int, int, int]) -> None:
    with open_source(files["tiles"]) as source, pytest.raises(UsageError, match="not inside the picture of 71×53"):
        source.read(*window)
