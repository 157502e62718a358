"""Channels of OME-TIFF as bands, z and t as pages."""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile

import sgicodec
from sgicodec.errors import PictureError, UsageError
from sgicodec.image.source import open_source
from sgicodec.metadata.gdal_items import band_facts
from sgicodec.metadata.georeference import resolution

SIZES = {"C": 3, "Z": 2, "T": 4, "Y": 40, "X": 50}
NAMES = ["DAPI", "FITC", "Cy5"]


def stack(path: Path, axes: str, dtype: str = "uint16", **options: Any) -> np.ndarray:
    """A file of these axes; returns its samples."""
    shape = tuple(SIZES[axis] for axis in axes)
    samples = (np.arange(np.prod(shape)) % 60_000).astype(dtype).reshape(shape)
    facts = {"axes": axes, "Channel": {"Name": NAMES}, "PhysicalSizeX": 0.5, "PhysicalSizeY": 0.25}
    tifffile.imwrite(path, samples, ome=True, photometric="minisblack", metadata=facts, **options)
    return samples


def planes(samples: np.ndarray, axes: str) -> list[np.ndarray]:
    """[H, W, C] for each t and z."""
    found = []
    for t, z in itertools.product(range(SIZES["T"] if "T" in axes else 1), range(SIZES["Z"] if "Z" in axes else 1)):
        plane = samples[tuple({"T": t, "Z": z}.get(axis, slice(None)) for axis in axes)]
        found.append(np.moveaxis(plane, 0, -1))
    return found


@pytest.mark.parametrize("axes", ["CYX", "TZCYX", "TCZYX", "CTZYX", "ZTCYX"])
@pytest.mark.parametrize("options", [{}, {"tile": (16, 16), "compression": "zlib"}, {"rowsperstrip": 7}])
def test_bands_are_channels(axes: str, options: dict[str, Any], tmp_path: Path) -> None:
    expected = planes(stack(tmp_path / "a.ome.tif", axes, **options), axes)
    with open_source(tmp_path / "a.ome.tif") as source:
        assert source.pages == len(expected)
        assert source.channels == "multi"
        np.testing.assert_array_equal(source.read(13, 9, 20, 30).pixels, expected[0][9:39, 13:33])
        np.testing.assert_array_equal(source.read(0, 2, 50, 5).pixels, expected[0][2:7])  # back again
    for number, plane in enumerate(expected):
        picture = sgicodec.read(tmp_path / "a.ome.tif", page=number + 1)
        np.testing.assert_array_equal(picture.pixels, plane)
        assert [facts.description for facts in band_facts(picture.metadata.geo, 3)] == NAMES
        assert resolution(picture.metadata.geo, picture.metadata.exif).microns == (0.5, 0.25)
    with pytest.raises(UsageError, match=f"there is no page {len(expected) + 1}"):
        sgicodec.read(tmp_path / "a.ome.tif", page=len(expected) + 1)


def test_planes_may_be_stated_one_by_one(tmp_path: Path) -> None:
    """As Bio-Formats writes them, here in reverse."""
    samples = stack(tmp_path / "a.ome.tif", "CYX")
    text = tifffile.tiffcomment(tmp_path / "a.ome.tif")
    parts = "".join(
        f'<TiffData FirstC="{c}" FirstZ="0" FirstT="0" IFD="{2 - c}" PlaneCount="1">'
        f'<UUID FileName="a.ome.tif">urn:uuid:0</UUID></TiffData>'
        for c in range(3)
    )
    tifffile.tiffcomment(tmp_path / "a.ome.tif", re.sub("<TiffData[^>]*/>", parts, text).encode())
    np.testing.assert_array_equal(sgicodec.read(tmp_path / "a.ome.tif").pixels, np.moveaxis(samples[::-1], 0, -1))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('SizeC="3"', 'SizeC="4"'),
        ('SizeC="3"', 'SizeC="x"'),
        ('DimensionOrder="XYCZT"', 'DimensionOrder="XYCC"'),
        ('IFD="0"', 'IFD="2"'),
        ('IFD="0"', 'IFD="-1"'),
        ("</Pixels>", "</Pixels"),
        ("<TiffData IFD", '<TiffData FirstC="7" IFD'),
        ("<OME ", "<!DOCTYPE OME><OME "),
    ],
)
def test_of_what_is_no_sound_description_planes_stay_pages(old: str, new: str, tmp_path: Path) -> None:
    samples = stack(tmp_path / "a.ome.tif", "CYX")
    text = tifffile.tiffcomment(tmp_path / "a.ome.tif")
    assert old in text
    tifffile.tiffcomment(tmp_path / "a.ome.tif", text.replace(old, new).encode())
    for page in (1, 2, 3):
        pixels = sgicodec.read(tmp_path / "a.ome.tif", page=page).pixels
        np.testing.assert_array_equal(pixels[..., 0], samples[page - 1])


def test_one_channel_and_colours_stay_what_they_are(tmp_path: Path) -> None:
    samples = stack(tmp_path / "a.ome.tif", "ZYX")
    with open_source(tmp_path / "a.ome.tif") as source:
        assert (source.pages, source.channels) == (2, "gray")
        np.testing.assert_array_equal(source.read(0, 0, 50, 40).pixels[..., 0], samples[0])
    colours = np.zeros((40, 50, 3), np.uint8)
    tifffile.imwrite(tmp_path / "b.ome.tif", colours, ome=True, photometric="rgb", metadata={"axes": "YXS"})
    assert sgicodec.read(tmp_path / "b.ome.tif").channels == "rgb"


def test_what_openimageio_does_not_read(tmp_path: Path) -> None:
    stack(tmp_path / "a.ome.tif", "CYX", compression="zstd")
    with pytest.raises(PictureError, match=r"its channels are planes of their own, and .*; save it as TIFF by Deflate"):
        sgicodec.read(tmp_path / "a.ome.tif")
