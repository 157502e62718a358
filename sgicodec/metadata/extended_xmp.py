"""XMP packets longer than a JPEG segment, in two parts (XMP part 3, §1.1.3.1).

The main packet names its extension, which travels in pieces, by the MD5 of it. Here the largest properties move to the
extension; a packet that is joined again has the same properties in another order.
"""

from __future__ import annotations

import hashlib
import re
import struct
from collections.abc import Iterator
from xml.parsers import expat

__all__ = ["joined", "split"]

_NOTE = b"http://ns.adobe.com/xmp/note/"
_HAS_EXTENSION = re.compile(
    rb"""\s[\w.-]+:HasExtendedXMP\s*=\s*["']([0-9A-Fa-f]{32})["']|"""
    rb"""<([\w.-]+:HasExtendedXMP)\s*>\s*([0-9A-Fa-f]{32})\s*</\2\s*>"""
)
_HEAD = struct.Struct(">32sII")
_PIECE = 65400
_MAX_EXTENSION = 1 << 26
"""Bytes of an extension that is read."""

_RDF_START, _RDF_END = re.compile(rb"<([\w.-]+):RDF\b[^<>]*>"), re.compile(rb"</[\w.-]+:RDF\s*>")
_DECLARED = re.compile(rb"""\s(xmlns:[\w.-]+)\s*=\s*("[^"<]*"|'[^'<]*')""")
_ABOUT = re.compile(rb"""\s[\w.-]+:about\s*=\s*("[^"<]*"|'[^'<]*')""")
_ATTRIBUTE = re.compile(rb"""\s+([^\s=<>]+)\s*=\s*(?:"[^"<]*"|'[^'<]*')""")
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


def split(packet: bytes, most: int) -> tuple[bytes, list[bytes]]:
    """The main packet of at most so many bytes, and the pieces of its extension, none if it needs none. What cannot be
    divided comes back whole.
    """
    packet = packet if len(packet) <= most else _without_padding(packet)
    inner, end = _rdf(packet)
    names = {name: value[1:-1] for name, value in _DECLARED.findall(packet)}
    if len(packet) <= most or inner is None or end is None or _is_ambiguous(packet, names):
        return packet, []
    rdf = inner[1]
    about = _ABOUT.search(packet, inner.end())
    subject = b" %b:about=%b" % (rdf, about[1] if about else b'""')
    note = b'<%b:Description%b xmlns:xmpNote="%b" xmpNote:HasExtendedXMP="%%b"/>' % (rdf, subject, _NOTE)
    spans = _largest(_properties(packet), len(packet) + len(note) + 30 - most)
    if not spans:
        return packet, []
    extension = _extension(rdf, subject, names, [packet[start:stop] for start, stop in spans])
    name = hashlib.md5(extension, usedforsecurity=False).hexdigest().upper().encode("ascii")
    kept = zip([0, *(stop for _, stop in spans)], [*(start for start, _ in spans), end.start()], strict=True)
    main = b"".join(packet[start:stop] for start, stop in kept) + note % name + packet[end.start() :]
    pieces = [extension[at : at + _PIECE] for at in range(0, len(extension), _PIECE)]
    return main, [_HEAD.pack(name, len(extension), at * _PIECE) + piece for at, piece in enumerate(pieces)]


def _is_ambiguous(packet: bytes, names: dict[bytes, bytes]) -> bool:
    """Whether a prefix means several things, or entities hide what the text says."""
    declared = {(name, value[1:-1]) for name, value in _DECLARED.findall(packet)}
    return len(declared) != len(names) or b"<!DOCTYPE" in packet


def _without_padding(packet: bytes) -> bytes:
    """The white space before the end of a packet is there for programs that write into it."""
    at = packet.rfind(b"<?xpacket end")
    return packet if at < 0 else packet[:at].rstrip() + b"\n" + packet[at:]


def _largest(spans: list[tuple[int, int]], least: int) -> list[tuple[int, int]]:
    """As few of them as have that many bytes together, or all, in their order."""
    taken: list[tuple[int, int]] = []
    for start, stop in sorted(spans, key=lambda span: span[0] - span[1]):
        if least <= 0:
            break
        taken.append((start, stop))
        least -= stop - start
    return sorted(taken)


def _extension(rdf: bytes, subject: bytes, names: dict[bytes, bytes], texts: list[bytes]) -> bytes:
    """A packet of these properties."""
    own = b"xmlns:" + rdf
    declared = b"".join(b' %b="%b"' % pair for pair in names.items() if pair[0] not in (own, b"xmlns:x"))
    attributes = b"".join(text for text in texts if not text.startswith(b"<"))
    elements = b"".join(text for text in texts if text.startswith(b"<"))
    head = b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><%b:RDF %b="%b">' % (rdf, own, names.get(own, b""))
    body = b"<%b:Description%b%b%b>%b</%b:Description>" % (rdf, subject, declared, attributes, elements, rdf)
    return head + body + b"</%b:RDF></x:xmpmeta>" % rdf


def _properties(packet: bytes) -> list[tuple[int, int]]:
    """Start and end of every property of the picture, in its element or attribute; none if the text is no XML."""
    parser = expat.ParserCreate()
    found: list[tuple[int, int]] = []
    stack: list[tuple[str, int]] = []

    def begin(name: str, _: dict[str, str]) -> None:
        at = parser.CurrentByteIndex
        if stack and stack[-1][0].endswith(":RDF"):
            found.extend(_attributes(packet, at + 1 + len(name.encode())))
        stack.append((name, at))

    def finish(_: str) -> None:
        start, at = stack.pop()[1], parser.CurrentByteIndex
        if len(stack) > 1 and stack[-2][0].endswith(":RDF") and packet[at : at + 2] == b"</":
            found.append((start, packet.index(b">", at) + 1))

    parser.StartElementHandler, parser.EndElementHandler = begin, finish
    try:
        parser.Parse(packet, True)
    except expat.ExpatError:
        return []
    return found


def _attributes(packet: bytes, at: int) -> Iterator[tuple[int, int]]:
    """Start and end of the attributes from `at` on that are properties."""
    while (attribute := _ATTRIBUTE.match(packet, at)) is not None:
        at, name = attribute.end(), attribute[1]
        if not name.startswith((b"xml:", b"xmlns")) and not name.endswith((b":about", b":ID", b":nodeID")):
            yield attribute.span()
