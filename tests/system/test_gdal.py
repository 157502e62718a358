"""The driver of GDAL, built against the headers that are there, in GDAL's own programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gdal_programs import NEEDS_GDAL, Run, info, pixels
from library import ROOT
from range_server import served

import sgicodec
from sgicodec.picture import Metadata, Picture

pytestmark = NEEDS_GDAL

GOLDEN = ROOT / "tests" / "conformance" / "golden"


NAMES = (
    "rgb8",
    "rgb8-tiles",
    "rgba8",
    "gray8-alpha",
    "gray16",
    "float",
    "multi8",
    "multi16-bands",
    "float-tiles-exact",
)
TEXTURE = ("rgb8-texture", "rgb8-tiles-texture", "rgb8-any-texture", "rgba8-tiles-colours", "gray16-texture")
RESTORED = ("rgb8-restored", "rgb8-restored-psnr", "rgba8-tiles-restored", "gray16-restored")


@pytest.mark.parametrize("name", [*NAMES, *TEXTURE, *RESTORED])
def test_samples_are_those_of_the_decoder(name: str, gdal: Run, tmp_path: Path) -> None:
    path = GOLDEN / f"{name}.sgi"
    with sgicodec.open(path) as stream:
        np.testing.assert_array_equal(pixels(gdal, path, tmp_path / "a.tif"), stream.read())
        part = pixels(gdal, path, tmp_path / "b.tif", "-srcwin", 5, 9, 40, 30)
        np.testing.assert_array_equal(part, stream.read((5, 9, 40, 30)))
        found = info(gdal, path)
        assert (found["driverShortName"], found["size"]) == ("SGICODEC", [stream.width, stream.height])
        colours = {
            "rgb": ["Red", "Green", "Blue"],
            "rgba": ["Red", "Green", "Blue", "Alpha"],
            "gray": ["Gray"],
            "gray+alpha": ["Gray", "Alpha"],
        }
        bands = ["Gray", *["Undefined"] * (stream.header.spec.channels - 1)]  # as of a TIFF where nothing else is said
        expected = colours.get(stream.header.channels, bands)
        assert [band["colorInterpretation"] for band in found["bands"]] == expected


def test_overviews_are_the_levels(pyramid: Path, gdal: Run, tmp_path: Path) -> None:
    found = info(gdal, pyramid)
    assert [each["size"] for each in found["bands"][2]["overviews"]] == [[260, 150], [130, 75]]
    with sgicodec.open(pyramid) as stream:
        for level in (1, 2):
            small = pixels(gdal, pyramid, tmp_path / "a.tif", "-oo", f"OVERVIEW_LEVEL={level - 1}")
            np.testing.assert_allclose(small.astype(int), stream.read_level(level), atol=1)


def test_place_and_nodata(on_map: Path, gdal: Run, tmp_path: Path) -> None:
    found = info(gdal, on_map)
    assert found["geoTransform"] == [500000, 10, 0, 5400000, 0, -10]
    assert 'ID["EPSG",32632]' in found["coordinateSystem"]["wkt"]
    assert found["bands"][0]["noDataValue"] == -9999
    assert found["bands"][0]["type"] == "Float32"
    cut = info(gdal, on_map, "-stats")["bands"][0]
    with sgicodec.open(on_map) as stream:
        values = stream.read()[stream.read() != -9999]
    assert (cut["minimum"], cut["maximum"]) == pytest.approx((values.min(), values.max()), abs=0.001)
    gdal("gdalwarp", "-q", "-t_srs", "EPSG:4326", on_map, tmp_path / "warped.tif")


def test_metadata(gdal: Run, tmp_path: Path) -> None:
    icc = (ROOT / "tests" / "data" / "pictures" / "icc_profile.png").read_bytes()[:300]
    xmp = b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>"
    picture = Picture(np.zeros((8, 9, 3), np.uint8), "rgb", (0, 255), Metadata(icc=icc, xmp=xmp, geo=b"II*\0cut off"))
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
    found = info(gdal, tmp_path / "a.sgi", "-mdd", "all")["metadata"]
    assert found["xml:XMP"] == [xmp.decode()] or xmp.decode() in str(found["xml:XMP"])
    assert len(found["COLOR_PROFILE"]["SOURCE_ICC_PROFILE"]) == 400
    assert found["IMAGE_STRUCTURE"]["COMPRESSION"] == "SGICODEC"


def test_rational_polynomials(gdal: Run, tmp_path: Path) -> None:
    """RPCCoefficient: 92 doubles, of which the third and fourth are offsets of line and sample."""
    values = np.arange(1.0, 93.0, dtype="<f8").tobytes()
    row = bytes.fromhex("0100 9cc6 0c00 5c00 0000 1a00 0000 0000 0000")
    picture = Picture(np.zeros((8, 9, 1), np.uint8), "gray", (0, 255), Metadata(geo=b"II*\0\x08\0\0\0" + row + values))
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(picture, steps=1))
    found = info(gdal, tmp_path / "a.sgi")["metadata"]["RPC"]
    assert [float(found[name]) for name in ("LINE_OFF", "SAMP_OFF", "HEIGHT_SCALE")] == [3, 4, 12]


def test_ranges_of_a_server(gdal: Run, tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (64, 1024, 3), np.uint8)
    data = sgicodec.encode(noise, quality=95, steps=2, tile=64, rdoq=False)
    with served({"a.sgi": data}) as server:
        path = f"/vsicurl/{server.url}/a.sgi"
        part = pixels(gdal, path, tmp_path / "a.tif", "-srcwin", 0, 0, 20, 20)
        assert server.bytes <= 0.7 * len(data)
    np.testing.assert_array_equal(part, sgicodec.decode(data)[:20, :20])


def test_silicon_graphics_goes_on(gdal: Run) -> None:
    """As far as GDAL has a driver for it, which 3.13 has no more; that of streams does not take it for its own."""
    if "SGI -raster-" not in gdal("gdalinfo", "--formats").stdout:
        refused = gdal("gdalinfo", ROOT / "tests" / "data" / "pictures" / "hopper.sgi", fails=True)
        assert "not recognized as being in a supported file format" in refused.stderr
        return
    assert info(gdal, ROOT / "tests" / "data" / "pictures" / "hopper.sgi")["driverShortName"] == "SGI"


def test_what_goes_wrong(gdal: Run, tmp_path: Path) -> None:
    data = bytearray((GOLDEN / "rgb8.sgi").read_bytes())
    (tmp_path / "cut.sgi").write_bytes(data[:-9])
    assert "cut.sgi: the file ends inside" in gdal("gdalinfo", tmp_path / "cut.sgi", fails=True).stderr
    data[len(data) // 2] ^= 255
    (tmp_path / "flipped.sgi").write_bytes(data)
    failed = gdal("gdal_translate", "-q", tmp_path / "flipped.sgi", tmp_path / "a.tif", fails=True)
    assert "the file is damaged" in failed.stderr
