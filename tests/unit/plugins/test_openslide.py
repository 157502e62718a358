"""Streams as slides, in OpenSlide's own programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sgicodec
from sgicodec.errors import UsageError
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.openslide import Slide


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


def test_microns_and_description() -> None:
    """As an Aperio slide states them."""
    text = b"Aperio Image Library|AppMag = 40|MPP = 0.2525\0\0"
    exif = b"II*\0\x08\0\0\0" + bytes.fromhex("0100 0e01 0200") + len(text).to_bytes(4, "little")
    exif += bytes.fromhex("1a000000 00000000") + text
    picture = Picture(np.zeros((20, 30, 3), np.uint8), "rgb", (0, 255), Metadata(exif=exif))
    slide = Slide(sgicodec.encode(picture, steps=1))
    assert slide.properties["openslide.mpp-x"] == slide.properties["openslide.mpp-y"] == "0.2525"
    assert slide.properties["openslide.comment"] == "Aperio Image Library|AppMag = 40|MPP = 0.2525"
