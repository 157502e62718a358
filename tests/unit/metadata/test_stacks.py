"""Descriptions that state the shape of a stack, and the size of pixels in them."""

from __future__ import annotations

import struct

import pytest
from tags import text

from sgicodec.metadata import ifd
from sgicodec.metadata.stacks import without_shape


def pixels_per_cm(directory: ifd.Directory) -> list[float] | None:
    found = [directory.get(tag) for tag in (282, 283)]
    ratios = [struct.unpack("<II", entry.data) for entry in found if isinstance(entry, ifd.Entry)]
    return [above / below for above, below in ratios] or None


@pytest.mark.parametrize(
    ("stated", "expected"),
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
def test_shapes_go_and_sizes_stay(stated: str, expected: list[float] | None) -> None:
    kept = without_shape({270: text(stated), 305: text("x")})
    assert 270 not in kept
    assert 305 in kept
    assert pixels_per_cm(kept) == (None if expected is None else pytest.approx(expected))
