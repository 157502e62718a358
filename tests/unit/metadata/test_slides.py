"""What descriptions of slides state, and how it follows a view."""

from __future__ import annotations

import pytest

from sgicodec.metadata import exif, ifd
from sgicodec.metadata.motion import Motion
from sgicodec.metadata.slides import magnification, microns_per_pixel, scaled
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
