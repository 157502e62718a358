"""Streams as OME-Zarr, as zarr and the specification of NGFF 0.4 have it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import zarr
from command import done, refused, sgi
from data_files import GOLDEN
from tags import exif_of, text

import sgicodec
from sgicodec.decoder import bands
from sgicodec.metadata import geo
from sgicodec.metadata.gdal_items import band_facts, named_bands
from sgicodec.metadata.stacks import resolution_tags
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.ome_xml import ome_xml
from sgicodec.plugins.ome_zarr import write_ome_zarr


@pytest.fixture(scope="module")
def stream() -> sgicodec.Stream:
    """Bands of 16 bits in several tiles, with names, of half a micrometre."""
    y, x = np.mgrid[:300, :520]
    pixels = np.stack([x + y, 3 * x + 2 * y + 1, y + 4000], axis=2).astype(np.uint16)
    tags = resolution_tags(["0.5", "0.25"]) | named_bands(["DAPI", "", "Cy5"])
    picture = Picture(pixels, "multi", ((0, 0, 4000), (1000, 4095, 4500)), Metadata(geo=geo.pack(tags)))
    return sgicodec.open(sgicodec.encode(picture, steps=2, tile=256, rdoq=False, overview=False))


def test_levels_and_what_is_said_of_them(
    stream: sgicodec.Stream, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bands, "BAND_SAMPLES", 70 * 520 * 3)
    rows: list[int] = []
    write_ome_zarr(stream, tmp_path / "a.zarr", done=rows.append)
    assert rows[-1] == 300
    group = zarr.open_group(tmp_path / "a.zarr", mode="r")
    assert group.metadata.zarr_format == 2
    scales = group.attrs["multiscales"][0]
    assert (scales["version"], [axis["name"] for axis in scales["axes"]]) == ("0.4", ["c", "y", "x"])
    assert [axis.get("unit") for axis in scales["axes"]] == [None, "micrometer", "micrometer"]
    sizes = [(level.width, level.height) for level in stream.levels]
    assert len(scales["datasets"]) == len(sizes) > 1
    for (width, height), dataset in zip(sizes, scales["datasets"], strict=True):
        samples = group[dataset["path"]]
        assert samples.metadata.dimension_separator == "/"
        np.testing.assert_array_equal(np.moveaxis(samples[:], 0, -1), stream.read(size=(width, height)))
        scale = dataset["coordinateTransformations"][0]["scale"]
        assert scale == pytest.approx([1, 0.25 * 300 / height, 0.5 * 520 / width])
    channels = group.attrs["omero"]["channels"]
    assert [channel.get("label") for channel in channels] == ["DAPI", None, "Cy5"]
    assert channels[1]["window"] == {"min": 0, "max": 4095, "start": 0, "end": 4095}
    assert [path.name for path in tmp_path.iterdir()] == ["a.zarr"]


def test_a_part_at_a_scale_has_the_size_of_its_pixels(stream: sgicodec.Stream, tmp_path: Path) -> None:
    view = {"region": (100, 30, 300, 260), "scale": 0.5}
    write_ome_zarr(stream, tmp_path / "a.zarr", **view)
    group = zarr.open_group(tmp_path / "a.zarr", mode="r")
    assert group.attrs["multiscales"][0]["datasets"][0]["coordinateTransformations"][0]["scale"] == [1, 0.5, 1]
    np.testing.assert_array_equal(np.moveaxis(group["0"][:], 0, -1), stream.read(**view))


@pytest.mark.parametrize("name", ["rgb8", "rgba8", "gray8-alpha", "gray16", "float", "multi8"])
def test_layouts_come_back(name: str, tmp_path: Path) -> None:
    done("decode", GOLDEN / f"{name}.sgi", tmp_path / "a.ome.zarr", "--quiet")
    picture = sgicodec.read(tmp_path / "a.ome.zarr")
    with sgicodec.open(GOLDEN / f"{name}.sgi") as stream:
        assert (picture.channels, picture.pixels.dtype) == (stream.header.channels, stream.dtype)
        np.testing.assert_array_equal(picture.pixels.squeeze(), stream.read())


def test_names_and_size_survive_an_encode(stream: sgicodec.Stream, tmp_path: Path) -> None:
    write_ome_zarr(stream, tmp_path / "a.zarr")
    done("encode", f"{tmp_path / 'a.zarr'}/", "-e", 1, "--tile", 256, "--quiet")
    with sgicodec.open(tmp_path / "a.sgi") as again:
        assert [facts.description for facts in band_facts(again.metadata.geo, 3)] == ["DAPI", None, "Cy5"]
    assert "0.5 × 0.25 µm per pixel" in sgi("info", tmp_path / "a.sgi").output


def test_the_name_of_a_single_channel_is_kept(tmp_path: Path) -> None:
    picture = Picture(np.zeros((9, 9, 1), np.uint8), "gray", (0, 255), Metadata(geo=geo.pack(named_bands(["DAPI"]))))
    found = sgicodec.open(sgicodec.encode(picture, steps=2))
    write_ome_zarr(found, tmp_path / "a.zarr")
    assert band_facts(sgicodec.read(tmp_path / "a.zarr").metadata.geo, 1)[0].description == "DAPI"
    assert 'Name="DAPI"' in ome_xml(found, 9, 9, np.dtype(np.uint8), None).decode()


def test_a_description_is_kept() -> None:
    exif = exif_of({270: text("slide 7 \x01& <a>")})
    picture = Picture(np.zeros((9, 9, 1), np.uint8), "gray", (0, 255), Metadata(exif=exif))
    found = ome_xml(sgicodec.open(sgicodec.encode(picture, steps=2)), 9, 9, np.dtype(np.uint8), None).decode()
    assert "<Description>slide 7 &amp; &lt;a&gt;</Description>" in found


def test_what_may_be_replaced(tmp_path: Path) -> None:
    out, source = tmp_path / "a.zarr", GOLDEN / "rgb8.sgi"
    done("decode", source, out)
    (out / "old").touch()
    assert refused(6, "decode", source, out) == f"sgi: {out} exists; give -f to overwrite it\n"
    assert (out / "old").exists()
    done("decode", source, out, "-f")
    assert not (out / "old").exists()
    other = tmp_path / "b.zarr"
    other.mkdir()
    (other / "letter.txt").touch()
    assert "is not replaced" in refused(2, "decode", source, other, "-f")
    assert (other / "letter.txt").exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.zarr", "b.zarr"]


@pytest.mark.parametrize("failure", [OSError(28, "full"), KeyboardInterrupt()])
def test_what_was_there_comes_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException) -> None:
    out, rename, fail = tmp_path / "a.zarr", Path.rename, Mock(side_effect=failure)
    done("decode", GOLDEN / "rgb8.sgi", out)
    (out / "old").touch()
    monkeypatch.setattr(Path, "rename", lambda path, to: fail() if path.name == "new" else rename(path, to))
    assert sgi("decode", GOLDEN / "rgb8.sgi", out, "-f").exit_code > 0
    assert (out / "old").exists()


def test_what_goes_not_together(stream: sgicodec.Stream, tmp_path: Path) -> None:
    for option in ("--pyramid", "--cog", "--format=png"):
        assert "is OME-Zarr" in refused(2, "decode", GOLDEN / "rgb8.sgi", tmp_path / "a.zarr", option)
    assert not list(tmp_path.iterdir())


FULL = """
import resource, sys, sgicodec
from sgicodec.plugins.ome_xml import ome_xml
from sgicodec.plugins.ome_zarr import write_ome_zarr
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
try:
    write_ome_zarr(sgicodec.open(sys.argv[1]), sys.argv[2], size=(3000, 2000))
except sgicodec.SgiError as error:
    print(error)
"""


def test_a_failure_leaves_nothing_and_prints_nothing(tmp_path: Path) -> None:
    """Some chunks are smaller than what files may have, and many are written at a time."""
    pytest.importorskip("resource")
    out = tmp_path / "a.zarr"
    command = [sys.executable, "-c", FULL, str(GOLDEN / "rgb8.sgi"), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == (f"{out}: File too large\n", "")
    assert list(tmp_path.iterdir()) == []
