"""Pictures as they are written, in all formats; files that cannot grow end with an ordinary error."""

from __future__ import annotations

import io
import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from image_files import noise, packed

from sgicodec import read, write
from sgicodec.errors import PictureError, UsageError
from sgicodec.image.formats import FORMATS, find
from sgicodec.metadata.layouts import LAYOUTS
from sgicodec.picture import Picture, full_range

EXACT = [
    (holder.name, dtype, layout)
    for holder in FORMATS
    for dtype in holder.dtypes
    for layout in holder.layouts
    if layout != "multi"
    and holder.name not in ("jpeg", "hdr")
    and not (holder.associated and layout in ("gray+alpha", "rgba"))
]


def _picture(dtype: str, layout: str, height: int = 40, width: int = 48) -> Picture:
    return Picture(noise(height, width, LAYOUTS[layout], dtype), layout, full_range(dtype))


@pytest.mark.parametrize(("format", "dtype", "layout"), EXACT)
def test_lossless_formats_are_exact(format: str, dtype: str, layout: str) -> None:
    picture = _picture(dtype, layout)
    if format == "webp":
        picture.pixels[..., 3:] |= 1  # WebP forgets colours under no alpha
    back = read(packed(picture, format))
    assert (back.channels, back.pixels.dtype) == (layout, picture.pixels.dtype)
    np.testing.assert_array_equal(back.pixels, picture.pixels)


@pytest.mark.parametrize("layout", ["gray+alpha", "rgba"])
def test_exr_alpha_is_associated_in_the_file_only(tmp_path: Path, layout: str) -> None:
    picture = _picture("float32", layout)
    picture.pixels[..., -1] = np.linspace(0.0, 1.0, 40 * 48).reshape(40, 48)
    write(picture, tmp_path / "x.exr")
    stored = oiio.ImageInput.open(str(tmp_path / "x.exr")).read_image("float")
    np.testing.assert_allclose(stored[1:, :, 0], picture.pixels[1:, :, 0] * picture.pixels[1:, :, -1], rtol=1e-6)
    np.testing.assert_allclose(read(tmp_path / "x.exr").pixels, picture.pixels, rtol=1e-6)


def test_jpeg_2000_needs_sides_of_32_pixels() -> None:
    picture = _picture("uint8", "rgb", height=31)
    with pytest.raises(PictureError, match="jpeg2000 cannot hold sides of fewer than 32 pixels"):
        packed(picture, "jp2")
    assert read(packed(_picture("uint8", "rgb", height=32), "jp2")).pixels.shape == (32, 48, 3)


def test_jpeg_is_close(tmp_path: Path) -> None:
    ramp = np.linspace(0, 255, 64 * 64 * 3).reshape(64, 64, 3).astype(np.uint8)
    write(Picture(ramp, "rgb", (0.0, 255.0)), tmp_path / "x.jpg")
    assert np.abs(read(tmp_path / "x.jpg").pixels.astype(int) - ramp).max() <= 3


@pytest.mark.parametrize("sample", [-0.25, np.inf, np.nan])
def test_samples_that_radiance_cannot_hold_are_refused(tmp_path: Path, sample: float) -> None:
    """OpenImageIO would write some other number."""
    picture = _picture("float32", "rgb")
    picture.pixels[30, 20, 1] = sample
    with pytest.raises(PictureError, match="negative, infinite or undefined samples; choose exr"):
        write(picture, tmp_path / "x.hdr")
    assert not (tmp_path / "x.hdr").exists()


@pytest.mark.parametrize("format", [holder.name for holder in FORMATS])
def test_equal_pictures_make_equal_bytes(format: str, monkeypatch: pytest.MonkeyPatch) -> None:
    holder = find(format)
    picture = _picture(holder.dtypes[0], "rgb" if "rgb" in holder.layouts else "gray")
    if holder.positive:
        np.abs(picture.pixels, out=picture.pixels)
    files = []
    for zone in ("UTC", "Asia/Tokyo"):  # so that an hour of writing would show
        monkeypatch.setenv("TZ", zone)
        time.tzset()
        files.append(packed(picture, format))
    monkeypatch.undo()
    time.tzset()
    assert files[0] == files[1]


@pytest.mark.parametrize(
    ("format", "dtype", "layout", "message"),
    [
        ("jpeg", "uint16", "rgb", "jpeg cannot hold 16 bits per sample, only 8 bits"),
        ("jpeg", "uint8", "rgba", "jpeg cannot hold rgba, only gray, rgb"),
        ("png", "float32", "gray", "png cannot hold 32-bit float per sample, only 8 bits or 16 bits"),
        ("pfm", "uint8", "rgb", "pfm cannot hold 8 bits per sample"),
        ("ppm", "uint8", "rgba", "pnm cannot hold rgba"),
        ("pgm", "uint8", "rgb", "pgm cannot hold rgb, only gray"),
        ("exr", "uint16", "rgb", "openexr cannot hold 16 bits"),
        ("webp", "uint8", "gray", "webp cannot hold gray"),
    ],
)
def test_nothing_is_dropped_silently(format: str, dtype: str, layout: str, message: str) -> None:
    with pytest.raises(PictureError, match=message):
        packed(_picture(dtype, layout), format)


def test_bands_go_to_tiff_and_exr_only() -> None:
    bands = Picture(noise(8, 9, 12, "float32"), "multi", (0.0, 1.0))
    with pytest.raises(PictureError, match="png cannot hold 12 bands"):
        packed(bands, "png")
    for format in ("tiff", "exr"):
        np.testing.assert_array_equal(read(packed(bands, format)).pixels, bands.pixels)


def test_a_depth_that_is_asked_for(tmp_path: Path) -> None:
    picture = _picture("uint16", "rgb")
    write(picture, tmp_path / "x.png", depth=8)
    expected = np.rint(picture.pixels.astype(np.float64) * 255 / 65535)
    assert np.abs(read(tmp_path / "x.png").pixels - expected).max() == 0
    write(picture, tmp_path / "x.pfm", depth=32)
    np.testing.assert_allclose(read(tmp_path / "x.pfm").pixels, picture.pixels / 65535, rtol=1e-6)
    with pytest.raises(UsageError, match="8, 16 or 32"):
        write(picture, tmp_path / "x.png", depth=10)


def test_names_of_no_format_are_refused(tmp_path: Path) -> None:
    picture = _picture("uint8", "rgb")
    with pytest.raises(PictureError, match=r"x\.gif: '\.gif' is no picture format .*choose one of png, tif"):
        write(picture, tmp_path / "x.gif")
    with pytest.raises(PictureError, match="the picture: '' is no picture format"):
        write(picture, io.BytesIO())


MOST = 1 << 14


@contextmanager
def limited() -> Iterator[None]:
    """A block in which no file of this process may grow beyond 16 KiB. No fixture: pytest may report into a file."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def noisy_picture(extension: str) -> Picture:
    floats = extension in ("exr", "hdr", "pfm")
    samples = np.random.default_rng(1).integers(0, 256, (120, 160, 3), np.uint8)
    return Picture(samples.astype(np.float32), "rgb", (0.0, 255.0)) if floats else Picture(samples, "rgb", (0.0, 255.0))


@pytest.mark.parametrize("extension", [holder.extensions[0] for holder in FORMATS])
def test_a_file_that_cannot_grow(tmp_path: Path, extension: str) -> None:
    target = tmp_path / f"x.{extension}"
    target.write_bytes(b"what was there")
    with limited(), pytest.raises(PictureError, match=rf"x\.{extension}: ") as caught:
        write(noisy_picture(extension), target)
    assert ".sgicodec-" not in str(caught.value)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"what was there"]


def test_what_went_through_a_pipe_is_whole(tmp_path: Path) -> None:
    """More than a pipe holds, written at the end while the writer holds Python's lock."""
    samples = np.random.default_rng(2).integers(0, 256, (600, 500, 3), np.uint8)
    write(Picture(samples, "rgb", (0.0, 255.0)), tmp_path / "x.webp")
    assert (tmp_path / "x.webp").stat().st_size > 1 << 18
    np.testing.assert_array_equal(read(tmp_path / "x.webp").pixels, samples)
