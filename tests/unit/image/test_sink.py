from __future__ import annotations

import io
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import tifffile
from examples import examples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from image_files import noise, packed

from sgicodec import read, write
from sgicodec.errors import PictureError, UsageError
from sgicodec.image import output, sink
from sgicodec.image.formats import FORMATS
from sgicodec.image.sink import open_sink
from sgicodec.metadata import geo, ifd
from sgicodec.metadata.layouts import LAYOUTS
from sgicodec.picture import Metadata, Picture, full_range

GEO = geo.pack({geo.PIXEL_SCALE: ifd.Entry(12, np.array([2.0, 2.0, 0.0]).tobytes())})


def _in_bands(picture: Picture, heights: list[int], format: str) -> bytes:
    """The file of a picture whose rows come in bands of these heights, again and again."""
    file = io.BytesIO()
    bands = picture.pixels.shape[2] if picture.channels == "multi" else None
    size, dtype = (picture.width, picture.height), picture.pixels.dtype
    with open_sink(file, *size, picture.channels, dtype, picture.metadata, bands=bands, format=format) as sink:
        y = 0
        while y < picture.height:
            band = picture.pixels[y : y + heights[0]]
            sink.write_rows(y, band)
            y += len(band)
            heights = [*heights[1:], heights[0]]
    return file.getvalue()


@pytest.mark.parametrize("holder", FORMATS, ids=lambda holder: holder.name)
@settings(max_examples=examples(5))
@given(heights=st.lists(st.integers(1, 30), min_size=1, max_size=4))
def test_the_bands_of_rows_leave_no_trace(holder: output.Format, heights: list[int]) -> None:
    layout = next(layout for layout in ("rgba", "rgb", "gray") if layout in holder.layouts)
    random = np.random.default_rng(3)
    pixels = random.integers(1, 200, (41, 37, LAYOUTS[layout])).astype(holder.dtypes[-1])
    picture = Picture(pixels, layout, full_range(pixels.dtype), Metadata(xmp=b"<x/>", geo=GEO))
    data = packed(picture, holder.name)
    assert _in_bands(picture, heights, holder.name) == data
    if holder.name not in ("jpeg", "hdr", "webp", "openexr"):
        np.testing.assert_array_equal(read(data).pixels, pixels)


@settings(max_examples=examples(20), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(heights=st.lists(st.integers(1, 300), min_size=1, max_size=4), count=st.sampled_from([1, 3, 5]))
def test_tiled_tiff(heights: list[int], count: int) -> None:
    pixels = np.random.default_rng(1).integers(0, 65536, (530, 301, count), np.uint16)
    channels = {1: "gray", 3: "rgb", 5: "multi"}[count]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "_TILED_PIXELS", 1000)
        data = _in_bands(Picture(pixels, channels, (0.0, 65535.0), Metadata(geo=GEO)), heights, "tiff")
    back = read(data)
    np.testing.assert_array_equal(back.pixels, pixels)
    assert back.metadata.geo == GEO
    directory = ifd.load(data)
    assert [np.frombuffer(directory[tag].data, "<u2").tolist() for tag in (322, 323)] == [[256], [256]]
    assert len(directory[324].data) == 4 * 3 * 2  # places of tiles, down and across


def test_large_tiff_is_big(monkeypatch: pytest.MonkeyPatch) -> None:
    picture = Picture(noise(40, 30, 3, "uint8"), "rgb", (0.0, 255.0), Metadata(xmp=b"<x/>", geo=GEO))
    for limit, signature in ((1 << 30, b"II*\0"), (100, b"II+\0")):
        monkeypatch.setattr(output, "_CLASSIC_BYTES", limit)
        data = _in_bands(picture, [7], "tiff")
        assert data[:4] == signature
        back = read(data)
        np.testing.assert_array_equal(back.pixels, picture.pixels)
        assert back.metadata == picture.metadata


def test_an_exception_leaves_what_was_there(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    pixels = noise(40, 32, 3, "uint8")
    for holder in FORMATS:
        if "uint8" not in holder.dtypes or "rgb" not in holder.layouts:
            continue
        target = tmp_path / f"x.{holder.extensions[0]}"
        target.write_bytes(b"before")
        with pytest.raises(UsageError, match="follow"), open_sink(target, 32, 40, "rgb", "uint8") as sink:
            [sink.write_rows(0, pixels[:10]) for _ in "twice"]
        assert target.read_bytes() == b"before"
        target.unlink()
        assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr().err == ""


def test_rows_that_do_not_follow(tmp_path: Path) -> None:
    rows = noise(10, 30, 3, "uint8")
    with open_sink(tmp_path / "x.png", 30, 15, "rgb", "uint8") as sink:
        with pytest.raises(UsageError, match="rows 5 to 15 do not follow: 0 of 15"):
            sink.write_rows(5, rows)
        sink.write_rows(0, rows)
        with pytest.raises(UsageError, match="rows 10 to 20 do not follow: 10 of 15"):
            sink.write_rows(10, rows)
        for wrong in (rows[:, 1:], rows[..., :2], rows.astype(np.uint16), rows[0]):
            with pytest.raises(UsageError, match=r"rows must be uint8 \[n, 30, 3\]"):
                sink.write_rows(10, wrong)
        sink.write_rows(10, rows[:5])
    np.testing.assert_array_equal(read(tmp_path / "x.png").pixels, np.concatenate([rows, rows[:5]]))


@pytest.mark.parametrize(
    "holder", [holder for holder in FORMATS if "rgb" in holder.layouts], ids=lambda holder: holder.name
)
def test_formats_written_from_memory_have_a_cap(holder: output.Format, tmp_path: Path) -> None:
    target = tmp_path / f"x.{holder.extensions[0]}"
    arguments = (target, 100, 100, "rgb", holder.dtypes[0])
    if holder.in_library:
        with pytest.raises(PictureError, match="written from memory, and 30000 samples are more than the cap of 29999"):
            open_sink(*arguments, max_samples=29999)
    else:
        open_sink(*arguments, max_samples=29999).abort()
    open_sink(*arguments, max_samples=30000).abort()
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_noticed_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = 30_000_000 + (1 << 20)
    monkeypatch.setattr(sink.shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(free, 0, free))
    open_sink(tmp_path / "x.tif", 10_000, 1000, "rgb", "uint8").abort()
    with pytest.raises(PictureError, match="free disk space"):  # its file is rewritten, and stands there twice
        open_sink(tmp_path / "x.jpg", 10_000, 1000, "rgb", "uint8")


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text here")
def test_a_folder_whose_name_is_no_text(tmp_path: Path) -> None:
    """PNG is written without OpenImageIO, which cannot open it."""
    folder = tmp_path / "\udcff"
    folder.mkdir()
    picture = Picture(noise(5, 6, 3, "uint8"), "rgb", full_range("uint8"))
    write(picture, folder / "a.png")
    np.testing.assert_array_equal(read(folder / "a.png").pixels, picture.pixels)
    with pytest.raises(PictureError, match="the name of its folder is not UTF-8"):
        write(picture, folder / "a.tif")


@pytest.mark.parametrize("count", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("size", [(9, 7), (2100, 2100)], ids=["strips", "tiles"])
def test_bands_without_a_meaning_are_no_colours(tmp_path: Path, count: int, size: tuple[int, int]) -> None:
    pixels = np.zeros((*size, count), np.uint8) + np.arange(count, dtype=np.uint8)
    write(Picture(pixels, "multi", (0.0, 255.0)), tmp_path / "x.tif")
    with tifffile.TiffFile(tmp_path / "x.tif") as file:
        page = file.pages.first
        assert (page.photometric, page.extrasamples) == (tifffile.PHOTOMETRIC.MINISBLACK, (0,) * (count - 1))
        assert page.is_tiled == (size[0] > 2000)
        np.testing.assert_array_equal(page.asarray().reshape(pixels.shape), pixels)
    back = read(tmp_path / "x.tif")
    assert back.channels == {1: "gray"}.get(count, "multi")


def test_colours_and_alpha_are_declared_so(tmp_path: Path) -> None:
    for channels, count in LAYOUTS.items():
        write(Picture(noise(5, 6, count, "uint8"), channels, (0.0, 255.0)), tmp_path / "x.tif")
        with tifffile.TiffFile(tmp_path / "x.tif") as file:
            page = file.pages.first
            assert page.photometric.name == ("RGB" if channels.startswith("rgb") else "MINISBLACK")
            assert page.extrasamples == ((2,) if count in (2, 4) else ())
