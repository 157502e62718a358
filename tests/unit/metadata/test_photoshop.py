"""What Photoshop keeps beside pixels, in its own files and in JPEG and TIFF."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from tags import exif_blob

from sgicodec import open_source
from sgicodec.errors import PictureError
from sgicodec.metadata import density, photoshop
from sgicodec.metadata.embedded import extract
from sgicodec.metadata.left_behind import left_behind


def resource(number: int, contents: bytes) -> bytes:
    return b"8BIM" + struct.pack(">HHI", number, 0, len(contents)) + contents + bytes(len(contents) % 2)


def psd(mode: int, channels: int, resources: bytes = b"", layers: int = 0) -> bytes:
    head = struct.pack(">4sH6xHIIHHI", b"8BPS", 1, channels, 4, 4, 8, mode, 0)
    section = struct.pack(">IIh", 6, 2, layers) if layers else bytes(4)
    return head + struct.pack(">I", len(resources)) + resources + section + bytes(2) + bytes(16 * channels)


MANY = resource(1034, b"\1") + resource(2001, bytes(26)) + resource(1028, b"\x1c")
NAMES = ["IPTC", "clipping paths", "Photoshop's copyright"]


@pytest.mark.parametrize(
    ("data", "names"),
    [
        (psd(3, 3, resource(1034, b"\0") + resource(1005, bytes(16)) + resource(1060, b"<x/>")), []),
        (psd(4, 4), ["inks (RGB instead)"]),
        (psd(3, 5, layers=-2), ["another channel", "layers"]),
        (psd(1, 3, MANY), ["2 more channels", *NAMES]),
        (psd(1, 3, MANY)[:60], ["2 more channels", NAMES[2]]),
        (psd(1, 3, MANY)[:20], []),
        (b"\xff\xd8\xff\xed" + struct.pack(">H", 16 + len(MANY)) + b"Photoshop 3.0\0" + MANY + b"\xff\xd9", NAMES),
    ],
)
def test_what_is_not_kept_is_named(data: bytes, names: list[str]) -> None:
    assert left_behind(data) == names
    assert photoshop.is_psd(data) == (data[:4] == b"8BPS" and len(data) > 20)


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_inks_of_any_colour_are_refused(channels: int) -> None:
    """OpenImageIO would show three of them as red, green and blue, and the fourth as alpha."""
    with pytest.raises(PictureError, match=r"inks without a colour space \(Multichannel\)"):
        open_source(psd(7, channels))


def test_metadata_comes(tmp_path: Path) -> None:
    blob, stated = exif_blob(orientation=1), struct.pack(">IHHIHH", 300 << 16, 1, 1, 200 << 16, 1, 1)
    (tmp_path / "a.psd").write_bytes(psd(3, 3, resource(1058, blob) + resource(1060, b"<x/>") + resource(1005, stated)))
    with open_source(tmp_path / "a.psd") as source:
        assert (source.metadata.exif, source.metadata.xmp) == (blob, b"<x/>")
        assert source.notes == ()
        found = density.density(source.metadata.geo, None)
    assert found.dpi == (300, 200)
    assert extract(psd(3, 3)[:30]).exif is None
