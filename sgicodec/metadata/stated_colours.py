"""What BMP, QOI and TIFF files say of their colours without an ICC profile, where it is not sRGB."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from sgicodec.metadata import ifd
from sgicodec.metadata.filebytes import Bytes

_WHITE, _PRIMARIES, _TRANSFER, _PROFILE = 318, 319, 301, 34675
TIFF_TAGS = {_WHITE, _PRIMARIES, _TRANSFER, _PROFILE}
WHITE, PRIMARIES = (0.3127, 0.329), (0.64, 0.33, 0.3, 0.6, 0.15, 0.06)
"""Chromaticities x, y of sRGB: of white, and of red, green and blue (IEC 61966-2-1)."""
_SRGB = ((_WHITE, "WhitePoint", WHITE), (_PRIMARIES, "PrimaryChromaticities", PRIMARIES))
_NEAR, _NEAR_LEVELS = 2e-3, 655
"""In chromaticities, and in levels of 16 bits: a hundredth."""
_BMP_HEADER, _VERSION_4, _CALIBRATED, _LINKED = 14, 108, b"\0\0\0\0", b"KNIL"


def of_bmp(data: Bytes) -> list[str]:
    """Endpoints and gammas in a header of version 4 or 5, or a profile in another file. Raises struct.error."""
    header = bytes(data[_BMP_HEADER : _BMP_HEADER + _VERSION_4])
    (size,) = struct.unpack_from("<I", header)
    if size < _VERSION_4 or len(header) < _VERSION_4:
        return []
    if header[56:60] == _LINKED:
        return ["ICC profile (in another file)"]
    return ["colour space (calibrated RGB)"] if header[56:60] == _CALIBRATED and any(header[60:]) else []


def of_qoi(data: Bytes) -> list[str]:
    """The header's word on linear samples."""
    return ["colour space (linear)"] if bytes(data[13:14]) == b"\1" else []


def of_tiff(entries: dict[int, ifd.Entry]) -> list[str]:
    """White, primaries and transfer function in these tags; nothing where a profile says more."""
    if _PROFILE in entries:
        return []
    found = [name for tag, name, usual in _SRGB if tag in entries and not _is_near(entries[tag], usual)]
    if _TRANSFER in entries and not _is_usual_curve(entries[_TRANSFER].data):
        found.append("TransferFunction")
    return [f"colour space ({', '.join(found)})"] if found else []


def _is_near(entry: ifd.Entry, usual: Sequence[float]) -> bool:
    if len(entry.data) != 8 * len(usual):
        return False
    ratios = [across / down if down else 0.0 for across, down in struct.iter_unpack("<II", entry.data)]
    return all(abs(a - b) < _NEAR for a, b in zip(ratios, usual, strict=True))


def _is_usual_curve(data: bytes) -> bool:
    """Whether tables of one or three curves are near sRGB's, or its approximation by a power of 2.2."""
    values = struct.unpack(f"<{len(data) // 2}H", data[: len(data) // 2 * 2])
    count = len(values) // (3 if len(values) % 3 == 0 else 1)  # a power of 2
    if count < 2:
        return False
    return all(abs(value - 65535 * (at % count / (count - 1)) ** 2.2) < _NEAR_LEVELS for at, value in enumerate(values))
