"""Slides by OpenSlide: pixels, size of a pixel, background; what is said of files that only seem to be slides."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import openslide
import pytest
import tifffile
from PIL import Image

import sgicodec
from sgicodec.errors import MissingExtraError, PictureError
from sgicodec.image.slide_reader import is_slide
from sgicodec.metadata.georeference import resolution
from sgicodec.metadata.tiff import DESCRIPTION, described

WIDTH, HEIGHT = 700, 300


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    return np.stack([120 + 100 * np.sin(x / 60), 120 + 90 * np.cos(y / 50), (x + y) / 5], axis=2).astype(np.uint8)


@pytest.fixture(scope="module")
def slide(pixels: np.ndarray, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As Aperio's scanners write them with JPEG 2000: with a thumbnail, a label and a macro."""
    path = tmp_path_factory.mktemp("slide") / "a.svs"
    with tifffile.TiffWriter(path) as file:
        text = "Aperio Image Library v11.0.37\n700x300 (256x256) J2K/YUV16 Q=70|AppMag = 40|MPP = 0.2525"
        options = {"compression": "APERIO_JP2000_RGB", "compressionargs": {"level": 0}, "photometric": "rgb"}
        file.write(pixels, tile=(256, 256), description=text, metadata=None, **options)
        for name, level, kind in (("", 200, 0), ("label ", 90, 1), ("macro ", 120, 9)):
            small = np.full((40, 60, 3), level, np.uint8)
            text = f"Aperio Image Library v11.0.37\n{name}60x40"
            file.write(small, description=text, metadata=None, photometric="rgb", subfiletype=kind)
    return path


def test_pixels_and_their_size(slide: Path, pixels: np.ndarray) -> None:
    assert is_slide(slide)
    picture = sgicodec.read(slide)
    assert (picture.channels, picture.pixels.dtype) == ("rgb", np.uint8)
    assert np.abs(picture.pixels.astype(int) - pixels).mean() < 1.5
    assert resolution(picture.metadata.geo, picture.metadata.exif).microns == pytest.approx((0.2525, 0.2525), rel=1e-8)
    assert described(picture.metadata.exif)[DESCRIPTION].data == b"aperio|AppMag = 40\0"


def test_windows(slide: Path) -> None:
    whole = sgicodec.read(slide).pixels
    with sgicodec.open_source(slide) as source:
        for x, y, width, height in ((0, 0, 700, 20), (500, 250, 200, 50), (255, 17, 2, 280)):
            np.testing.assert_array_equal(source.read(x, y, width, height).pixels, whole[y : y + height, x : x + width])


@pytest.mark.parametrize("compression", ["jpeg2000", "deflate"])
def test_pictures_beside_it_are_named(slide: Path, tmp_path: Path, compression: str) -> None:
    path = slide
    if compression == "deflate":  # which OpenImageIO reads
        path = tmp_path / "a.svs"
        with tifffile.TiffFile(slide) as old, tifffile.TiffWriter(path) as new:
            for page in old.pages:
                options = {"tile": (256, 256)} if page.is_tiled else {"subfiletype": page.subfiletype}
                text = {"description": page.description, "metadata": None}
                new.write(page.asarray(), photometric="rgb", compression="deflate", **options, **text)
    assert is_slide(path) == (compression == "jpeg2000")
    with sgicodec.open_source(path) as source:
        assert source.notes[-1] == "not kept: label, macro, thumbnail"


class Scan(SimpleNamespace):
    """A slide of MIRAX, of whose canvas a part was scanned."""

    def __init__(self, path: Path) -> None:
        bounds = {"x": 100, "y": 50, "width": 60, "height": 40}
        super().__init__(
            properties={f"openslide.bounds-{name}": str(value) for name, value in bounds.items()}
            | {"openslide.mpp-x": "0.25", "openslide.mpp-y": "none", "openslide.background-color": "0a1400"},
            dimensions=(1000, 900),
            color_profile=None,
            associated_images={},
        )

    def read_region(self, location: tuple[int, int], level: int, size: tuple[int, int]) -> Image.Image:
        assert level == 0
        x, y = np.meshgrid(location[0] + np.arange(size[0]), location[1] + np.arange(size[1]))
        rgba = np.stack([x, y, 0 * x, np.where(x < 130, 255, 0)], axis=2)
        return Image.fromarray(rgba.astype(np.uint8))

    def close(self) -> None:
        pass


@pytest.fixture
def scanned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(openslide, "OpenSlide", Scan)
    (tmp_path / "a.MRXS").write_bytes(b"")
    (tmp_path / "a").mkdir()
    return tmp_path / "a.MRXS"


def test_the_scanned_part_on_its_background(scanned: Path) -> None:
    picture = sgicodec.read(scanned)
    assert picture.pixels.shape == (40, 60, 3)
    assert picture.pixels[0, 0].tolist() == [100, 50, 0]
    assert picture.pixels[39, 29].tolist() == [129, 89, 0]
    assert picture.pixels[39, 30].tolist() == [10, 20, 0]
    assert picture.metadata.geo is None


def test_what_goes_wrong(tmp_path: Path, slide: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.ndpi").write_bytes(b"II*\0nothing of the kind")
    with pytest.raises(PictureError, match=r"^[^:]*a\.ndpi: it is no slide that OpenSlide reads"):
        sgicodec.read(tmp_path / "a.ndpi")
    (tmp_path / "cut.svs").write_bytes(slide.read_bytes())
    with tifffile.TiffFile(slide) as file:
        start, count = file.pages[0].dataoffsets[0], file.pages[0].databytecounts[0]
    with (tmp_path / "cut.svs").open("r+b") as file:
        file.seek(start)
        file.write(bytes(count))
    with pytest.raises(PictureError, match=r"cut\.svs: OpenSlide cannot read it: "):
        sgicodec.read(tmp_path / "cut.svs")
    monkeypatch.setitem(sys.modules, "openslide", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'sgicodec\[slides\]'"):
        sgicodec.read(slide)
