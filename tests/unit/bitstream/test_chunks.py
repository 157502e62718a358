"""The table of chunk kinds is that of docs/format.md, and what travels with a picture has a chunk for each field."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

from sgicodec.bitstream.chunks import CHUNKS, METADATA, metadata_of
from sgicodec.metadata.blobs import Metadata

PAGE = (Path(__file__).parents[3] / "docs" / "format.md").read_text()


def test_kinds_are_those_of_the_page_in_their_order() -> None:
    table = PAGE[PAGE.index("| type | content | times |") :].split("\n\n")[0]
    rows = re.findall(r"^\| `(\w)` \| .* \| ([^|]+) \|$", table, re.M)
    once = {letter: not times.startswith("one for each") for letter, times in rows}
    assert list(once.items()) == [(kind.letter, kind.is_once) for kind in CHUNKS]


def test_every_field_of_the_metadata_has_a_chunk() -> None:
    blobs = {letter: field.encode() for field, letter in METADATA.items()}
    assert metadata_of(blobs) == Metadata(**{field.name: field.name.encode() for field in fields(Metadata)})
    assert metadata_of({}) == Metadata()
