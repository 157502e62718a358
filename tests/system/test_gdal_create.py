"""Streams that GDAL's own programs write with the driver."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio
from data_files import geotiff
from gdal_programs import NEEDS_GDAL, Run, info, pixels

import sgicodec

pytestmark = NEEDS_GDAL

SGI = Path(sys.executable).with_name("sgi")
FAST = ("-co", "EFFORT=1", "-co", f"PROGRAM={SGI}")


def field(bands: int, dtype: str) -> np.ndarray:
    """Smooth samples [bands, 60, 80] with some noise."""
    y, x = np.mgrid[:60, :80]
    noise = np.random.default_rng(7).normal(0, 2, (bands, 60, 80))
    return (100 + 60 * np.sin(x / 9) * np.cos(y / 7) + noise + 5 * np.arange(bands)[:, None, None]).astype(dtype)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """Four named bands of 16 bits, with nodata."""
    samples = (37.3 * field(4, "float64")).astype("uint16")
    samples[:, :10, :10] = 0
    path = geotiff(tmp_path / "scene.tif", samples, nodata=0, photometric="minisblack", alpha="no")
    with rasterio.open(path, "r+") as file:
        file.descriptions = ("B2", "B3", "B4", "B8 near infrared")
        file.scales = (1e-4,) * 4
        file.update_tags(ACQUIRED="2024-06-01")
    return path


def create(gdal: Run, source: Path, out: object, *options: object, fails: bool = False) -> str:
    words = ("gdal_translate", "-q", "-of", "SGICODEC", source, out, *FAST, *options)
    return gdal(*words, fails=fails).stderr


def test_a_lossless_copy_is_the_source(scene: Path, gdal: Run, tmp_path: Path) -> None:
    out = tmp_path / "a.sgi"
    assert create(gdal, scene, out, "-co", "LOSSLESS=YES") == ""
    np.testing.assert_array_equal(pixels(gdal, out, tmp_path / "b.tif"), pixels(gdal, scene, tmp_path / "c.tif"))
    source, stream = info(gdal, scene), info(gdal, out)
    for key in ("size", "geoTransform", "coordinateSystem"):
        assert stream[key] == source[key]
    assert stream["metadata"]["IMAGE_STRUCTURE"]["COMPRESSION_REVERSIBILITY"] == "LOSSLESS"
    assert stream["metadata"][""]["ACQUIRED"] == "2024-06-01"
    for given, found in zip(source["bands"], stream["bands"], strict=True):
        for key in ("type", "description", "scale", "noDataValue", "colorInterpretation"):
            assert found.get(key) == given.get(key), key
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.sgi", "b.tif", "c.tif", "scene.tif"]


def test_loss_is_what_options_ask_for(scene: Path, gdal: Run, tmp_path: Path) -> None:
    sizes = []
    for quality in (20, 60, 90):
        create(gdal, scene, tmp_path / "a.sgi", "-co", f"QUALITY={quality}")
        sizes.append((tmp_path / "a.sgi").stat().st_size)
    assert sizes == sorted(set(sizes))
    create(gdal, scene, tmp_path / "a.sgi", "-co", "MAX_ERROR=9", "-co", "TUNE=psnr", "-co", "THREADS=1")
    with rasterio.open(scene) as file:
        error = np.abs(sgicodec.imread(tmp_path / "a.sgi").astype(int) - np.moveaxis(file.read(), 0, -1))
    assert 0 < error.max() <= 9
    assert info(gdal, tmp_path / "a.sgi")["metadata"]["IMAGE_STRUCTURE"]["COMPRESSION_REVERSIBILITY"] == "LOSSY"


def test_colours_and_alpha(gdal: Run, tmp_path: Path) -> None:
    samples = field(4, "uint8")
    samples[3] = np.where(samples[0] > 100, 255, 0)
    source = geotiff(tmp_path / "a.tif", samples, photometric="rgb", alpha="yes")
    create(gdal, source, tmp_path / "a.sgi")
    assert [band["colorInterpretation"] for band in info(gdal, tmp_path / "a.sgi")["bands"]] == [
        *("Red", "Green", "Blue", "Alpha")
    ]
    np.testing.assert_array_equal(sgicodec.imread(tmp_path / "a.sgi")[..., 3], samples[3])


def test_samples_of_other_types(gdal: Run, tmp_path: Path) -> None:
    """They become floats, which is said, and refused where the copy is to be strict. Few bits are not stretched."""
    source = geotiff(tmp_path / "a.tif", field(1, "int16") - 100)
    assert "samples of Int16 become Float32" in create(gdal, source, tmp_path / "a.sgi", "-co", "LOSSLESS=YES")
    np.testing.assert_array_equal(sgicodec.imread(tmp_path / "a.sgi"), field(1, "int16")[0] - 100)
    assert "become Float32" in create(gdal, source, tmp_path / "b.sgi", "-strict", fails=True)
    wide = geotiff(tmp_path / "w.tif", field(1, "float64"))
    said = create(gdal, wide, tmp_path / "w.sgi", "-co", "MAX_ERROR=1")
    assert "Float64 become Float32" in said
    assert "NBITS" not in said
    np.testing.assert_allclose(sgicodec.imread(tmp_path / "w.sgi"), field(1, "float64")[0], atol=1)
    twelve = geotiff(tmp_path / "c.tif", 10 * field(1, "uint16"), nbits=12)
    create(gdal, twelve, tmp_path / "c.sgi", "-co", "LOSSLESS=YES")
    np.testing.assert_array_equal(sgicodec.imread(tmp_path / "c.sgi"), 10 * field(1, "uint16")[0])
    complex_ones = geotiff(tmp_path / "d.tif", field(1, "complex64"))
    assert "one type" in create(gdal, complex_ones, tmp_path / "d.sgi", fails=True)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(("b.sgi", "d.sgi"))]


def test_a_mask_is_said_to_be_lost(gdal: Run, tmp_path: Path) -> None:
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True):
        source = geotiff(tmp_path / "a.tif", field(3, "uint8"), photometric="rgb")
        with rasterio.open(source, "r+") as file:
            file.write_mask(field(1, "uint8")[0] > 90)
    said = create(gdal, source, tmp_path / "a.sgi")
    assert "the mask is not kept; gdalwarp -dstalpha makes alpha of it, which is kept beside gray or RGB" in said
    assert len(said.splitlines()) == 1
    create(gdal, source, tmp_path / "b.sgi", "-strict", fails=True)
    gdal("gdalwarp", "-q", "-dstalpha", source, tmp_path / "alpha.tif")
    said = create(gdal, tmp_path / "alpha.tif", tmp_path / "c.sgi")
    assert "c.sgi: sgi: the last band is declared as alpha" in said
    np.testing.assert_array_equal(sgicodec.imread(tmp_path / "c.sgi")[..., 3] > 0, field(1, "uint8")[0] > 90)


@pytest.mark.parametrize("bands", [4, 5])
def test_colours_beside_other_bands(bands: int, gdal: Run, tmp_path: Path) -> None:
    source = geotiff(tmp_path / "a.tif", field(bands, "uint8"), photometric="rgb", alpha="no")
    assert create(gdal, source, tmp_path / "a.sgi", "-strict") == ""
    colours = ["Red", "Green", "Blue", "Undefined", "Undefined"][:bands]
    assert [band["colorInterpretation"] for band in info(gdal, tmp_path / "a.sgi")["bands"]] == colours


@pytest.mark.parametrize("bands", [3, 5])
def test_alpha_beside_other_bands_is_said_to_become_a_band(bands: int, gdal: Run, tmp_path: Path) -> None:
    source = geotiff(tmp_path / "a.tif", field(bands, "uint8"), photometric="minisblack", alpha="no")
    with rasterio.open(source, "r+") as file:
        file.colorinterp = [*(rasterio.enums.ColorInterp.undefined,) * (bands - 1), rasterio.enums.ColorInterp.alpha]
    assert "alpha becomes a band like the others" in create(gdal, source, tmp_path / "a.sgi")
    create(gdal, source, tmp_path / "b.sgi", "-strict", fails=True)
    assert create(gdal, source, tmp_path / "b.sgi", "-strict", "-co", "ALPHA=band") == ""


def test_a_palette_is_said_to_become_colours(gdal: Run, tmp_path: Path) -> None:
    source = geotiff(tmp_path / "a.tif", field(1, "uint8") // 40, nodata=0)
    with rasterio.open(source, "r+") as file:
        file.write_colormap(1, {number: (40 * number, 90, 0, 255) for number in range(7)})
    assert "a palette becomes its colours; class numbers" in create(gdal, source, tmp_path / "a.sgi")
    create(gdal, source, tmp_path / "b.sgi", "-strict", fails=True)


def test_what_goes_wrong(scene: Path, gdal: Run, tmp_path: Path) -> None:
    out = tmp_path / "a.sgi"
    nothing = ("-co", f"PROGRAM={tmp_path / 'nothing'}")
    said = gdal("gdal_translate", "-q", "-of", "SGICODEC", scene, out, *nothing, fails=True).stderr
    assert f"{tmp_path / 'nothing'}, which encodes, does not start; say where it is" in said
    said = create(gdal, scene, out, "-co", "QUALITY=500", fails=True)
    assert "sgi: " in said
    assert "copy.tif" not in create(gdal, scene, tmp_path / "no" / "a.sgi", fails=True)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.tif"]


def test_options_state_no_defaults_of_the_command_line(gdal: Run) -> None:
    options = gdal("gdalinfo", "--format", "SGICODEC").stdout.split("<Option ")
    stated = [option for option in options if option.startswith(('name="QUALITY"', 'name="EFFORT"', 'name="RANGE"'))]
    assert len(stated) == 3
    assert not any("default" in option for option in stated)


def test_other_file_systems_of_gdal(scene: Path, gdal: Run, tmp_path: Path) -> None:
    create(gdal, scene, f"/vsizip/{tmp_path}/a.zip/scene.sgi")
    assert info(gdal, f"/vsizip/{tmp_path}/a.zip/scene.sgi")["size"] == [80, 60]


ROTATED = "+proj=ob_tran +o_proj=longlat +o_lon_p=-162 +o_lat_p=39 +lon_0=180 +to_meter=0.01745 +datum=WGS84"


def test_what_geotiff_has_no_tags_for_is_named(scene: Path, gdal: Run, tmp_path: Path) -> None:
    virtual = tmp_path / "a.vrt"
    gdal("gdal_translate", "-q", "-of", "VRT", "-b", 1, "-a_srs", ROTATED, scene, virtual)
    names = "<CategoryNames><Category>water</Category><Category>wood</Category></CategoryNames></VRTRasterBand>"
    virtual.write_text(virtual.read_text().replace("</VRTRasterBand>", names))
    said = create(gdal, virtual, tmp_path / "a.sgi")
    assert said.splitlines() == [
        f"Warning 6: {tmp_path}/a.sgi: what GeoTIFF has no tags for is not kept: CategoryNames, SRS"
    ]
    create(gdal, virtual, tmp_path / "b.sgi", "-strict", fails=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.sgi", "a.vrt", "scene.tif"]


def test_a_strict_copy_of_bands_in_another_order(scene: Path, gdal: Run, tmp_path: Path) -> None:
    """GDAL calls the second of them gray in a file beside TIFF: that says nothing."""
    assert create(gdal, scene, tmp_path / "a.sgi", "-strict", "-b", 2, "-b", 1) == ""
    assert [band["description"] for band in info(gdal, tmp_path / "a.sgi")["bands"]] == ["B3", "B2"]
