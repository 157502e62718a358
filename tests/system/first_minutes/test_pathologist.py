"""A pathologist's first minutes: a slide becomes a stream, is looked at, and leaves as OME-TIFF of its size."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import openslide
import pytest
import tifffile

import sgicodec
from sgicodec.plugins.openslide import Slide

DATA = Path(__file__).parents[2] / "data"
SGI = Path(sys.executable).with_name("sgi")


@pytest.fixture
def slide(tmp_path: Path) -> Path:
    """Aperio's layout: a level in tiles of JPEG, a description with MPP and AppMag."""
    pixels = np.concatenate([sgicodec.read(DATA / f"kodim{number}.png").pixels for number in (13, 23)])
    description = "Aperio Image Library v12\r\n768x1024 (240x240) JPEG/RGB Q=90|AppMag = 20|MPP = 0.4990"
    tiles = {"tile": (240, 240), "photometric": "rgb", "compression": "jpeg", "compressionargs": {"level": 90}}
    tifffile.imwrite(tmp_path / "slide.svs", pixels, description=description, metadata=None, **tiles)
    return tmp_path / "slide.svs"


def sgi(*arguments: object) -> str:
    return subprocess.run([SGI, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


@pytest.mark.slow
def test_slide_to_stream_to_ome_tiff(slide: Path, tmp_path: Path) -> None:
    stream, ome, zarr = (tmp_path / f"slide.{name}" for name in ("sgi", "ome.tif", "ome.zarr"))
    sgi("encode", slide, stream, "-q", 60, "-e", 2, "--tile", 512)
    facts = json.loads(sgi("info", "--json", stream))
    assert (facts["magnification"], facts["resolution"]["microns_per_pixel"]) == ("20", [0.499, 0.499])
    assert stream.stat().st_size < slide.stat().st_size / 2

    with openslide.OpenSlide(slide) as before, Slide(stream) as after:
        assert after.dimensions == before.dimensions
        for name in ("openslide.mpp-x", "openslide.objective-power"):
            assert float(after.properties[name]) == float(before.properties[name])
        regions = [np.asarray(one.read_region((300, 400), 0, (200, 150)), int) for one in (before, after)]
        assert np.abs(regions[0] - regions[1]).mean() < 8

    sgi("decode", stream, ome, "--compress", "jpeg:85")
    assert ome.stat().st_size < 1.2 * slide.stat().st_size
    with tifffile.TiffFile(ome) as file:
        image = tifffile.xml2dict(file.ome_metadata)["OME"]
        assert image["Instrument"]["Objective"]["NominalMagnification"] == 20
        assert image["Image"]["Pixels"]["PhysicalSizeX"] == 0.499
        assert [level.shape[1] for level in file.series[0].levels] == [768, 384, 192]

    sgi("decode", stream, zarr)
    with sgicodec.open(stream) as found:
        np.testing.assert_array_equal(sgicodec.read(zarr).pixels, found.read())
