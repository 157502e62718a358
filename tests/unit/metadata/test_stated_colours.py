"""What files say of their colours without an ICC profile."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from image_files import by_pillow, by_tifffile, notes_of

from sgicodec import open_source
from sgicodec.errors import PictureError
from sgicodec.metadata.left_behind import left_behind

PIXELS = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)
WHITE, PRIMARIES = (3127, 10000, 3290, 10000), (64, 100, 33, 100, 30, 100, 60, 100, 15, 100, 6, 100)
POWER, LINEAR = (tuple(round(65535 * (at / 255) ** power) for at in range(256)) for power in (2.2, 1.0))


def tiff(*tags: tuple[int, int, int, tuple[int, ...], bool]) -> bytes:
    return by_tifffile(PIXELS, photometric="rgb", metadata=None, extratags=tags)


def bmp(version: int, kind: bytes, gamma: int = 0) -> bytes:
    plain = by_pillow(PIXELS, "BMP")
    head = struct.pack("<I", version) + plain[18:54] + bytes(16) + kind
    return plain[:14] + head.ljust(version - 4, b"\0") + struct.pack("<I", gamma) + plain[54:]


def hdr(*lines: str) -> bytes:
    text = "\n".join(["#?RADIANCE", "# EXPOSURE=9", "SOFTWARE=x", *lines, "", "-Y 1 +X 8", ""])
    return text.encode() + bytes([90, 80, 70, 128] * 8)


@pytest.mark.parametrize(
    ("data", "names"),
    [
        (tiff((318, 5, 2, WHITE, True), (319, 5, 6, PRIMARIES, True)), []),
        (tiff((318, 5, 2, (3457, 10000, 3585, 10000), True)), ["colour space (WhitePoint)"]),
        (tiff((319, 5, 6, (68, *PRIMARIES[1:]), True)), ["colour space (PrimaryChromaticities)"]),
        (tiff((301, 3, 768, POWER * 3, True)), []),
        (tiff((301, 3, 256, LINEAR, True)), ["colour space (TransferFunction)"]),
        (tiff((301, 3, 256, LINEAR, True), (34675, 7, 4, b"icc ", True)), []),
        (bmp(108, b"BGRs", 9), []),
        (bmp(108, bytes(4)), []),
        (bmp(108, bytes(4), 9), ["colour space (calibrated RGB)"]),
        (bmp(124, b"KNIL"), ["ICC profile (in another file)"]),
        (b"qoif" + bytes(8) + b"\3\0", []),
        (b"qoif" + bytes(8) + b"\3\1", ["colour space (linear)"]),
        (hdr("FORMAT=32-bit_rle_rgbe", "EXPOSURE= 1.0", "COLORCORR=1 1 1"), []),
        (hdr("PRIMARIES=.64 .33 .3 .6 .15 .06 .3333 .3333"), []),
        (hdr("PRIMARIES=.68 .32 .265 .69 .15 .06 .3127 .329", "OWNER=me"), ["colour space (PRIMARIES)", "OWNER"]),
        (hdr("EXPOSURE=4", "PIXASPECT=two"), ["EXPOSURE", "PIXASPECT"]),
    ],
)
def test_other_colours_are_named(data: bytes, names: list[str]) -> None:
    assert left_behind(data) == names


def test_radiance_in_xyz_is_refused(tmp_path: Path) -> None:
    for kind in ("rgbe", "xyze"):
        (tmp_path / f"{kind}.hdr").write_bytes(hdr(f"FORMAT=32-bit_rle_{kind}"))
    assert notes_of(tmp_path / "rgbe.hdr") == ()
    with pytest.raises(PictureError, match="its colours are XYZ"):
        open_source(tmp_path / "xyze.hdr")
