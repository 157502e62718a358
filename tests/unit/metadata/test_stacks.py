"""Descriptions that state the shape of a stack, and the size of pixels in them."""

from __future__ import annotations

import struct

import pytest

from sgicodec.metadata import ifd
from sgicodec.metadata.stacks import resolution_tags, without_shape


def described(text: str) -> ifd.Directory:
    return {270: ifd.Entry(2, text.encode() + b"\0"), 305: ifd.Entry(2, b"x\0")}


def pixels_per_cm(directory: ifd.Directory) -> list[float] | None:
    found = [directory.get(tag) for tag in (282, 283)]
    ratios = [struct.unpack("<II", entry.data) for entry in found if isinstance(entry, ifd.Entry)]
    return [above / below for above, below in ratios] or None


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('<OME><Pixels PhysicalSizeX="0.5" PhysicalSizeY="0.25" SizeZ="3"/></OME>', [20000, 40000]),
        ('<OME><Pixels PhysicalSizeX="5E-4" PhysicalSizeXUnit="mm"/></OME>\n', [20000, 20000]),
        ('<OME><Pixels PhysicalSizeX="500" PhysicalSizeXUnit="nm" PhysicalSizeYUnit="nm"/></OME>', [20000, 20000]),
        ('<OME><Pixels PhysicalSizeX="2" PhysicalSizeXUnit="&#181;m"/></OME>', [5000, 5000]),
        ('<OME><Pixels PhysicalSizeX="2" PhysicalSizeXUnit="pixel"/></OME>', None),
        ('<OME><Pixels PhysicalSizeX="2"/><Pixels PhysicalSizeX="3"/></OME>', None),
        ('<OME><Pixels PhysicalSizeX="two"/></OME>', None),
        ('<OME><Pixels PhysicalSizeX="0"/></OME>', None),
        ("ImageJ=1.53\nimages=3\nslices=3\n", None),
        ('{"shape": [3, 24, 32]}', None),
        ("shape=(3, 24, 32)", None),
    ],
)
def test_shapes_go_and_sizes_stay(text: str, expected: list[float] | None) -> None:
    kept = without_shape(described(text))
    assert 270 not in kept
    assert 305 in kept
    assert pixels_per_cm(kept) == (None if expected is None else pytest.approx(expected))


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("micron", 4e4), ("\\u00B5m", 4e4), ("um", 4e4), ("nm", 4e7), ("cm", 4.0), ("pixel", None), ("", None)],
)
def test_units_of_imagej(unit: str, expected: float | None) -> None:
    stated = {282: ifd.Entry(5, struct.pack("<II", 4, 1)), 283: ifd.Entry(5, struct.pack("<II", 8, 2))}
    kept = without_shape(described(f"ImageJ=1.53\nimages=3\nunit={unit}\n") | stated)
    assert pixels_per_cm(kept) == ([4, 4] if expected is None else pytest.approx([expected, expected]))


def test_the_magnification_stays() -> None:
    kept = without_shape(described('<OME><Objective NominalMagnification="40.0"/></OME>'))
    assert kept[270] == ifd.Entry(2, b"AppMag = 40.0\0")


@pytest.mark.parametrize("text", ["Aperio|MPP = 0.25", "A shape=(3)", "OME", "made with ImageJ=1", ""])
def test_other_descriptions_stay(text: str) -> None:
    assert without_shape(described(text)) == described(text)


def test_sizes_that_are_none() -> None:
    for sizes in (["0.5"], ["0.5", None], ["x", "1"], ["-1", "1"], ["1e-9", "1"]):
        assert resolution_tags(sizes) == {}
