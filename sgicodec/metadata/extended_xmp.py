"""XMP packets longer than a JPEG segment, which come in two parts (XMP part 3, §1.1.3.1).

The main packet names its extension, which travels in pieces, by the MD5 of it.
"""

from __future__ import annotations

import re
import struct

_HAS_EXTENSION = re.compile(
    rb"""\s[\w.-]+:HasExtendedXMP\s*=\s*["']([0-9A-Fa-f]{32})["']|"""
    rb"""<([\w.-]+:HasExtendedXMP)\s*>\s*([0-9A-Fa-f]{32})\s*</\2\s*>"""
)
_HEAD = struct.Struct(">32sII")
_MAX_EXTENSION = 1 << 26
"""Bytes of an extension that is read."""

_RDF_START, _RDF_END = re.compile(rb"<([\w.-]+):RDF\b[^<>]*>"), re.compile(rb"</[\w.-]+:RDF\s*>")
_DECLARED = re.compile(rb"""\s(xmlns:[\w.-]+)\s*=\s*("[^"<]*"|'[^'<]*')""")
_EMPTY = re.compile(rb"""<[\w.-]+:Description(?:\s+[\w.-]+:about="[^"<]*"|\s+xmlns:xmpNote="[^"<]*")*\s*/>""")
"""What is left of a note."""


def joined(main: bytes, pieces: list[bytes]) -> bytes:
    """The packet with the properties of its extension, if that is whole."""
    note = _HAS_EXTENSION.search(main)
    if note is None:
        return main
    extension = _assembled(note[1] or note[3], pieces)
    main = _EMPTY.sub(b"", main[: note.start()] + main[note.end() :])
    start, stop = (None, None) if extension is None else _rdf(extension)
    inner, end = _rdf(main)
    if extension is None or start is None or stop is None or inner is None or end is None:
        return main
    have = dict(_DECLARED.findall(inner[0]))
    outer = {name: value for name, value in _DECLARED.findall(extension[: start.end()]) if name not in have}
    extra = b"".join(b" %b=%b" % pair for pair in outer.items() if pair[0] != b"xmlns:x")
    at = inner.end() - 1
    return main[:at] + extra + main[at : end.start()] + extension[start.end() : stop.start()] + main[end.start() :]


def is_lost(main: bytes, pieces: list[bytes]) -> bool:
    """Whether there is an extension, or the name of one, that `joined` does not add."""
    note = _HAS_EXTENSION.search(main)
    return bool(pieces) if note is None else _assembled(note[1] or note[3], pieces) is None


def _rdf(packet: bytes) -> tuple[re.Match[bytes] | None, re.Match[bytes] | None]:
    """The tags between which properties stand."""
    start = _RDF_START.search(packet)
    return start, None if start is None else _RDF_END.search(packet, start.end())


def _assembled(name: bytes, pieces: list[bytes]) -> bytes | None:
    """The extension of this name out of its pieces, which may come in any order; None if it is not whole."""
    parts: dict[int, bytes] = {}
    lengths = set()
    for piece in pieces:
        if len(piece) > _HEAD.size and piece[:32].upper() == name.upper():
            _, length, offset = _HEAD.unpack_from(piece)
            lengths.add(length)
            parts[offset] = piece[_HEAD.size :]
    whole = b"".join(part for _, part in sorted(parts.items()))
    ends = [offset + len(part) for offset, part in sorted(parts.items())]
    is_whole = lengths == {len(whole)} and [0, *ends[:-1]] == sorted(parts)
    return whole if is_whole and len(whole) <= _MAX_EXTENSION else None


def without_padding(packet: bytes) -> bytes:
    """The white space before the end of a packet is there for programs that write into it."""
    at = packet.rfind(b"<?xpacket end")
    return packet if at < 0 else packet[:at].rstrip() + b"\n" + packet[at:]
