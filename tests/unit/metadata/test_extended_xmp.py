from __future__ import annotations

import hashlib
import io
import struct
import xml.etree.ElementTree as ET
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec import read, write
from sgicodec.metadata import extended_xmp
from sgicodec.picture import Metadata, Picture

MOST = 65502
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


PACKETS = {
    "elements": packet(' q:a="small"', f"<d:Data>{'x' * 70000}</d:Data><q:b>1</q:b><o:c>{'ä' * 20000}</o:c>"),
    "attribute": packet(f" q:a='1' d:Data = \"{'y' * 200000}\" q:z='a &gt; d:Data=0'", "<q:b/>"),
    "nested": packet("", "<d:Bag><rdf:Bag>" + "<rdf:li>entry</rdf:li>" * 5000 + "</rdf:Bag></d:Bag><q:b>2</q:b>"),
    "padded": packet(' q:a="1"', "<q:b>2</q:b>", " " * 70000),
}


@pytest.mark.parametrize("name", PACKETS)
def test_long_packets_come_back_from_a_jpeg(name: str) -> None:
    picture = Picture(np.full((9, 17, 3), 9, np.uint8), "rgb", (0.0, 255.0), Metadata(xmp=PACKETS[name]))
    for _ in range(2):
        file = io.BytesIO()
        write(picture, file, format="jpeg")
        picture = read(file.getvalue())
        assert picture.metadata.xmp is not None
        assert properties(picture.metadata.xmp) == properties(PACKETS[name])
        assert b"HasExtendedXMP" not in picture.metadata.xmp
    assert len(picture.metadata.xmp or b"") < len(PACKETS[name]) + 500


def test_pieces_come_in_any_order_and_whole() -> None:
    main, pieces = extended_xmp.split(PACKETS["attribute"], MOST)
    assert len(pieces) > 2
    other = b"0" * 32 + pieces[0][32:]
    assert properties(extended_xmp.joined(main, [other, *pieces[::-1]])) == properties(PACKETS["attribute"])
    for lacking in (pieces[1:], pieces[:-1], [], [other], [pieces[0][:36], *pieces[1:]]):
        assert properties(extended_xmp.joined(main, lacking)) == properties(
            packet(" q:a='1' q:z='a &gt; d:Data=0'", "<q:b/>")
        )


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
    joined = extended_xmp.joined(main, pieces)
    assert properties(joined) == Counter({"{urn:q}a=1": 1, "{urn:g}Data=abc": 1})
