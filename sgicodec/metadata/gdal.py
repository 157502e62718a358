"""Texts that GDAL keeps in tags of TIFF: its nodata value, and the items of its metadata."""

from __future__ import annotations

import re

_NUMBER = re.compile(
    rb"""\s* ([+-]?) (?:
        (?P<nan> (?:nan | 1\.\#(?:qnan|snan|ind)) (?![a-z]))
      | (?P<inf> (?:infinity | inf | 1\.\#inf) (?![a-z]))
      | (?P<digits> (?:\d+[.,]?\d* | [.,]\d+) (?:e[+-]?\d+)?)
    )""",
    re.IGNORECASE | re.VERBOSE,
)

_TAG = re.compile(rb"<[^<>]*>")
_ITEM = re.compile(
    rb"""<Item\s[^<>]*?\bname\s*=\s*["'](?:APPROX_)?(?:STATISTICS|HISTO|TIFFTAG_M(?:IN|AX)SAMPLEVALUE)""", re.IGNORECASE
)
_SCALING = re.compile(rb"""<Item\s[^<>]*?\brole\s*=\s*["'](?:scale|offset|unittype)["']""", re.IGNORECASE)
_HISTOGRAMS = re.compile(rb"<Histograms[\s/>]", re.IGNORECASE)
_END = {b"i": re.compile(rb"</Item\s*>", re.IGNORECASE), b"h": re.compile(rb"</Histograms\s*>", re.IGNORECASE)}
_EMPTY = re.compile(rb"\s*<GDALMetadata\s*>\s*</GDALMetadata\s*>\s*\Z")


def number(text: bytes) -> float | None:
    """The number at the beginning of a text, whatever follows it, as GDAL reads it (CPLAtofM): with a point or a comma,
    not-a-number and infinity also as Microsoft's libraries print them, 1.#QNAN. None where there is none.
    """
    found = _NUMBER.match(text)
    if found is None:
        return None
    digits = "nan" if found["nan"] else "inf" if found["inf"] else found["digits"].replace(b",", b".").decode("ascii")
    return float(found[1].decode("ascii") + digits)


def without_statistics(text: bytes) -> bytes:
    """GDAL's metadata without the items that state statistics or histograms of samples, wherever they stand; all else
    byte for byte. Empty if nothing is left.
    """
    return _without(text, (_ITEM, _HISTOGRAMS))


def without_numbers(text: bytes) -> bytes:
    """The same, also without scale, offset and unit of samples."""
    return _without(text, (_ITEM, _HISTOGRAMS, _SCALING))


def _without(text: bytes, elements: tuple[re.Pattern[bytes], ...]) -> bytes:
    kept, at = bytearray(), 0
    for tag in _TAG.finditer(text):
        if tag.start() < at or not any(element.match(tag[0]) for element in elements):
            continue
        end = tag if tag[0].endswith(b"/>") else _END[tag[0][1:2].lower()].search(text, tag.end())
        if end is None:
            break
        kept += text[at : tag.start()].rstrip()
        at = end.end()
    if at == 0:
        return text
    kept += text[at:]
    return b"" if _EMPTY.match(kept.rstrip(b"\0")) else bytes(kept)
