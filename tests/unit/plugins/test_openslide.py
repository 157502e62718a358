"""Streams as slides, in OpenSlide's own programs."""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
import openslide
import pytest
from openslide.deepzoom import DeepZoomGenerator
from PIL import Image

import sgicodec
from sgicodec.errors import MissingExtraError, RegionError, UsageError
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.openslide import Slide

PICTURES = Path(__file__).parents[2] / "data" / "pictures"
GOLDEN = Path(__file__).parents[2] / "conformance" / "golden"


def test_it_has_all_that_a_slide_has() -> None:
    wanted = {name for name in dir(openslide.OpenSlide) if not name.startswith("_")}
    assert wanted <= set(dir(Slide))


def test_levels_and_regions(pyramid: Path) -> None:
    with Slide(pyramid) as slide, sgicodec.open(pyramid) as stream:
        assert slide.level_count == 3
        assert slide.level_dimensions == ((520, 300), (260, 150), (130, 75))
        assert (slide.dimensions, slide.level_downsamples) == ((520, 300), (1.0, 2.0, 4.0))
        assert [slide.get_best_level_for_downsample(value) for value in (0.5, 1, 1.9, 2, 3.9, 100)] == [
            0,
            0,
            0,
            1,
            1,
            2,
        ]
        region = slide.read_region((100, 60), 1, (40, 30))
        assert (region.mode, region.size) == ("RGBA", (40, 30))
        np.testing.assert_array_equal(np.asarray(region)[..., :3], stream.read_region((100, 60), 1, (40, 30)))
        assert np.asarray(region)[..., 3].min() == 255
        assert slide.properties["openslide.level[2].width"] == "130"
        assert slide.properties["openslide.vendor"] == "sgicodec"
        assert "openslide.mpp-x" not in slide.properties
        assert dict(slide.associated_images) == {}


def test_files_beside_the_stream_are_associated(tmp_path: Path) -> None:
    (tmp_path / "a [1].sgi").write_bytes((GOLDEN / "rgb8.sgi").read_bytes())
    for name in ("a [1].label.png", "a [1].macro.png", "a 1.label.png", "a [1].png", "a [1].macro.jpg"):
        Image.new("RGB", (5, 4), "red").save(tmp_path / name)
    images = Slide(tmp_path / "a [1].sgi").associated_images
    assert {name: (image.mode, image.size) for name, image in images.items()} == {
        "label": ("RGBA", (5, 4)),
        "macro": ("RGBA", (5, 4)),
    }
    assert dict(Slide((GOLDEN / "rgb8.sgi").read_bytes()).associated_images) == {}


@pytest.mark.parametrize("level", [0, 1])
def test_outside_is_transparent(pyramid: Path, level: int) -> None:
    with Slide(pyramid) as slide:
        region = np.asarray(slide.read_region((510, -8), level, (40, 30)))
        columns, rows = 10 >> level, 8 >> level
        assert region[rows:, :columns, 3].min() == 255
        assert not region[:rows].any()
        assert not region[:, columns:].any()
        assert slide.read_region((0, 0), 0, (0, 5)).size == (0, 5)
        with pytest.raises(UsageError, match="negative"):
            slide.read_region((0, 0), 0, (-1, 5))


def test_deep_zoom_of_openslide(pyramid: Path) -> None:
    with Slide(pyramid) as slide, sgicodec.open(pyramid) as stream:
        zoom = DeepZoomGenerator(slide, tile_size=254, overlap=1)
        assert zoom.level_dimensions[-1] == (520, 300)
        tile = np.asarray(zoom.get_tile(zoom.level_count - 1, (1, 0)))
        np.testing.assert_array_equal(tile, stream.read((253, 0, 256, 255)))
        assert 'Width="520"' in zoom.get_dzi("png")


def test_microns_and_description() -> None:
    """As an Aperio slide states them."""
    text = b"Aperio Image Library|AppMag = 40|MPP = 0.2525\0\0"
    exif = b"II*\0\x08\0\0\0" + bytes.fromhex("0100 0e01 0200") + len(text).to_bytes(4, "little")
    exif += bytes.fromhex("1a000000 00000000") + text
    picture = Picture(np.zeros((20, 30, 3), np.uint8), "rgb", (0, 255), Metadata(exif=exif))
    slide = Slide(sgicodec.encode(picture, steps=1))
    assert slide.properties["openslide.mpp-x"] == slide.properties["openslide.mpp-y"] == "0.2525"
    assert slide.properties["openslide.comment"] == "Aperio Image Library|AppMag = 40|MPP = 0.2525"


def test_thumbnails(pyramid: Path) -> None:
    with Slide(pyramid) as slide:
        assert slide.get_thumbnail((100, 100)).size == (100, 57)
        assert slide.get_thumbnail((9999, 150)).size == (260, 150)
        assert slide.get_thumbnail((9999, 9999)).size == (520, 300)
        assert slide.get_thumbnail((50, 50)).mode == "RGB"
        with pytest.raises(RegionError):
            slide.get_thumbnail((0, 5))


@pytest.mark.parametrize("name", ["rgba8", "gray16", "gray8-alpha", "float", "multi8"])
def test_every_layout(name: str) -> None:
    with Slide(GOLDEN / f"{name}.sgi") as slide:
        region = slide.read_region((0, 0), 0, slide.dimensions)
        assert region.mode == "RGBA"
        with sgicodec.open(GOLDEN / f"{name}.sgi") as stream:
            if stream.header.channels in ("rgba", "gray+alpha"):
                np.testing.assert_array_equal(np.asarray(region)[..., 3], stream.read()[..., -1])


def test_nodata_is_transparent(on_map: Path) -> None:
    with Slide(on_map) as slide:
        alpha = np.asarray(slide.read_region((80, 50), 0, (20, 20)))[..., 3]
        np.testing.assert_array_equal(alpha == 0, np.pad(np.ones((10, 10), bool), ((0, 10), (0, 10))))


def test_profiles(tmp_path: Path) -> None:
    icc = Image.open(PICTURES / "icc_profile.png").info["icc_profile"]
    picture = Picture(np.zeros((8, 8, 3), np.uint8), "rgb", (0, 255), Metadata(icc=icc))
    slide = Slide(BytesIO(sgicodec.encode(picture, steps=1)))
    assert slide.color_profile.tobytes() == icc
    assert slide.read_region((0, 0), 0, (4, 4)).info["icc_profile"] == icc
    assert slide.get_thumbnail((4, 4)).info["icc_profile"] == icc


def test_formats(pyramid: Path) -> None:
    assert Slide.detect_format(pyramid) == "sgicodec"
    assert Slide.detect_format(PICTURES / "hopper.sgi") is None
    assert Slide.detect_format(pyramid.parent / "none") is None


def test_without_pillow(pyramid: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(MissingExtraError, match="a slide needs pillow"):
        Slide(pyramid)
