"""What descriptions of slides and of stacks state, and how it follows a view."""

from __future__ import annotations

import struct

import pytest
from tags import rational, text

from sgicodec.metadata import exif, ifd
from sgicodec.metadata.motion import Motion
from sgicodec.metadata.slides import magnification, microns_per_pixel, scaled
from sgicodec.metadata.stacks import without_shape
from sgicodec.metadata.tiff import DESCRIPTION, described


@pytest.mark.parametrize(
    ("text", "microns", "power"),
    [
        (b"Aperio|AppMag = 20|MPP = 0.4990|Left = 1", 0.499, "20"),
        (b"|MPP=.25|AppMag=2.5", 0.25, "2.5"),
        (b"|MPP = 0.4.9|AppMag = x", None, None),
        (b'<Objective NominalMagnification="63.0"/>', None, "63.0"),
        (b"XMPP = 3 fields", None, None),
    ],
)
def test_what_is_stated(text: bytes, microns: float | None, power: str | None) -> None:
    assert microns_per_pixel(text) == microns
    assert magnification(text) == power


@pytest.mark.parametrize(
    ("across", "down", "expected"),
    [
        (1, 1, b"a|MPP = 0.4990|b"),
        (0.5, 0.5, b"a|MPP = 0.998|b"),
        (0.5, 0.5005, b"a|MPP = 0.997501|b"),
        (3, 3, b"a|MPP = 0.166333|b"),
        (2, 1, b"a|MPP = |b"),
    ],
)
def test_a_size_follows_the_scale(across: float, down: float, expected: bytes) -> None:
    assert scaled(b"a|MPP = 0.4990|b", across, down) == expected


@pytest.mark.parametrize("scale", [0.5, 2, 3, 1 / 7])
@pytest.mark.parametrize("order", [b"II", b"MM"])
def test_the_tag_of_a_blob_follows(order: bytes, scale: float) -> None:
    text = b"a|MPP = 0.4990|AppMag = 20\0"
    little = b"II*\0\x08\0\0\0" + ifd.dump({DESCRIPTION: ifd.Entry(2, text), 272: ifd.Entry(2, b"a model\0")}, 8)
    big = b"MM\0*\0\0\0\x08\0\2"
    big += b"".join(bytes.fromhex(row) for row in ("010e 0002 0000001b 00000026", "0110 0002 00000008 00000042"))
    big += bytes(4) + text + b"\0" + b"a model\0"
    blob = {b"II": little, b"MM": big}[order]
    size = round(700 * scale)
    found = described(exif.moved(blob, Motion(700, 700, 1, 0, 0, scale, scale, size, size)))
    assert found[DESCRIPTION].data.rstrip(b"\0") == b"a|MPP = %s|AppMag = 20" % f"{0.499 / scale:.6g}".encode()
    assert found[272].data == b"a model\0"


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
        ('<OME><Pixels PhysicalSizeX="20" PhysicalSizeXUnit="Å"/></OME>', [5e6, 5e6]),
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


@pytest.mark.parametrize("unit", ["um", "µm", r"\u00B5m"])
def test_imagej_counts_pixels_in_its_unit(unit: str) -> None:
    stated = {270: text(f"ImageJ=1.54\nunit={unit}\n"), 282: rational(4), 283: rational(2)}
    assert pixels_per_cm(without_shape(stated)) == [40000, 20000]
