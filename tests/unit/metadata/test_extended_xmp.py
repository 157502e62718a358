from __future__ import annotations

import hashlib
import struct
import xml.etree.ElementTree as ET
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from image_files import packed

from sgicodec import read
from sgicodec.errors import PictureError
from sgicodec.metadata import extended_xmp
from sgicodec.picture import Metadata, Picture

RDF = "{http://www.w3.org/1999/02/22-rdf-syntax-ns#}"


def packet(attributes: str = "", elements: str = "", end: str = "") -> bytes:
    return (
        '<?xpacket begin="" id="W5M0"?><x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF '
        'xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:o="urn:outer">'
        f'<rdf:Description rdf:about="uuid:1" xmlns:d="urn:depth" xmlns:q="urn:q"{attributes}>{elements}'
        f'</rdf:Description></rdf:RDF></x:xmpmeta>{end}<?xpacket end="w"?>'
    ).encode()


def properties(text: bytes) -> Counter[str]:
    """Every property of a packet, whichever Description it stands in."""
    found: Counter[str] = Counter()
    for description in ET.fromstring(text).iter(RDF + "Description"):
        assert description.get(RDF + "about") == "uuid:1"
        found.update(f"{k}={v}" for k, v in description.attrib.items() if k != RDF + "about")
        found.update(ET.tostring(each).decode() for each in description)
    return found


def jpeg_of(xmp: bytes) -> bytes:
    return packed(Picture(np.full((9, 17, 3), 9, np.uint8), "rgb", (0.0, 255.0), Metadata(xmp=xmp)), "jpeg")


def test_a_long_packet_loses_its_padding_or_is_refused() -> None:
    padded = packet(' q:a="1"', "<q:b>2</q:b>", " " * 70000)
    found = read(jpeg_of(padded)).metadata.xmp
    assert len(found) < 1000
    assert properties(found) == properties(padded)
    with pytest.raises(PictureError, match=r"jpeg cannot hold \d+ bytes of XMP, only 65504"):
        jpeg_of(packet("", f"<d:Data>{'x' * 70000}</d:Data>"))


def pieces_of(extension: bytes, length: int) -> tuple[bytes, list[bytes]]:
    """The name of an extension, and its pieces of so many bytes."""
    name = hashlib.md5(extension).hexdigest().upper().encode()
    starts = range(0, len(extension), length)
    return name, [name + struct.pack(">II", len(extension), at) + extension[at : at + length] for at in starts]


def test_pieces_come_in_any_order_and_whole() -> None:
    extension = packet(f' d:Data="{"y" * 900}"')
    name, pieces = pieces_of(extension, 400)
    assert len(pieces) > 2
    note = f"<n:HasExtendedXMP>{name.decode()}</n:HasExtendedXMP>"
    main, other = packet(" q:a='1'", note), b"0" * 32 + pieces[0][32:]
    short = properties(packet(" q:a='1'"))
    assert properties(extended_xmp.joined(main, [other, *pieces[::-1]])) == short + properties(extension)
    for lacking in (pieces[1:], pieces[:-1], [], [other], [pieces[0][:36], *pieces[1:]]):
        assert properties(extended_xmp.joined(main, lacking)) == short


@given(st.binary(max_size=60), st.lists(st.binary(max_size=60), max_size=3))
def test_damage_raises_nothing(tail: bytes, pieces: list[bytes]) -> None:
    name = b"A" * 32
    main = b'<rdf:RDF><a n:HasExtendedXMP="' + name + b'"/></rdf:RDF>' + tail
    assert isinstance(extended_xmp.joined(main, [name + piece for piece in pieces]), bytes)


def test_an_extension_that_others_wrote_is_read() -> None:
    """A prefix declared outside of what moves, the note as an element, its name in small letters."""
    rdf = b"xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'"
    inner = b"<rdf:Description rdf:about='uuid:1' g:Data='abc'/>"
    extension = b"<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF " + rdf + b" xmlns:g='urn:g'>" + inner
    extension += b"</rdf:RDF></x:xmpmeta>"
    name = hashlib.md5(extension).hexdigest().lower()
    note = f"<n:HasExtendedXMP>{name}</n:HasExtendedXMP>"
    heads = {at: name.upper().encode() + struct.pack(">II", len(extension), at) for at in range(0, len(extension), 50)}
    pieces = [head + extension[at : at + 50] for at, head in heads.items()]
    main = packet(" q:a='1'", note)
    assert properties(extended_xmp.joined(main, pieces)) == Counter({"{urn:q}a=1": 1, "{urn:g}Data=abc": 1})
