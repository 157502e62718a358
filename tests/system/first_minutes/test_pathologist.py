"""The first minutes of a pathologist: a slide as a stream, in napari, and as OME-TIFF for QuPath."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
import tifffile
from data_files import DATA
from newcomer import Newcomer

import sgicodec

pytestmark = pytest.mark.slow

NAPARI = """
import json, npe2
npe2.PluginManager.instance().discover()
((levels, options, kind),) = npe2.read(["slide.sgi"], stack=False, plugin_name="sgicodec")
print(json.dumps([[list(level.shape) for level in levels], options["scale"], levels[-1].compute().mean()]))
"""
OPENSLIDE = """
from sgicodec.plugins.openslide import Slide
properties = Slide("slide.sgi").properties
print(properties["openslide.mpp-x"], properties["openslide.objective-power"])
"""


@pytest.fixture
def pathologist(newcomer: Newcomer) -> Newcomer:
    """Has a slide as Aperio's scanners write them: levels in tiles of JPEG, and a description."""
    one, two = (sgicodec.read(DATA / f"kodim{number}.png").pixels for number in (13, 23))
    pixels = np.vstack([np.hstack([one, two]), np.hstack([two, one])])
    text = "Aperio Image Library v11.2.1\r\n1536x1024 (256x256) JPEG/RGB Q=70|AppMag = 20|MPP = 0.4990"
    tiles = {"tile": (256, 256), "photometric": "rgb", "compression": "jpeg", "compressionargs": {"level": 70}}
    with tifffile.TiffWriter(newcomer.home / "slide.svs") as file:
        for step in (1, 4):
            file.write(pixels[::step, ::step], description=text, subfiletype=int(step > 1), metadata=None, **tiles)
    newcomer.install("sgicodec[tiff,viewers]", "napari")
    return newcomer


def test_a_slide(pathologist: Newcomer, reached: Callable[[str], None]) -> None:
    pathologist.run("sgi", "encode", "slide.svs", "-q", "60", "-e", "2")
    shapes, scale, mean = json.loads(pathologist.run("python", "-c", NAPARI))
    reached("a slide as a stream, as napari reads it,")
    assert shapes == [[1024 >> level, 1536 >> level, 3] for level in range(4)]
    assert scale == [0.499, 0.499]
    original = sgicodec.read(pathologist.home / "slide.svs").pixels
    assert abs(mean - original.mean()) < 2
    assert pathologist.run("python", "-c", OPENSLIDE).split() == ["0.499", "20"]
    pathologist.run("sgi", "decode", "slide.sgi", "slide.ome.tif", "--compress", "jpeg:70")
    sizes = [(pathologist.home / name).stat().st_size for name in ("slide.svs", "slide.sgi", "slide.ome.tif")]
    reached("OME-TIFF; {:,} bytes of SVS, {:,} of the stream, {:,} of OME-TIFF,".format(*sizes))
    assert sizes[1] < sizes[0] * 0.7
    assert sizes[2] < sizes[0] * 1.3
    with tifffile.TiffFile(pathologist.home / "slide.ome.tif") as file:
        assert [[*level.shape] for level in file.series[0].levels] == shapes
        assert file.ome_metadata is not None
        facts = tifffile.xml2dict(file.ome_metadata)["OME"]
        assert facts["Image"]["Pixels"]["PhysicalSizeX"] == 0.499
        assert facts["Instrument"]["Objective"]["NominalMagnification"] == 20
        assert np.abs(file.asarray().astype(int) - original).mean() < 12
