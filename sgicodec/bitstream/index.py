"""Chunk X, the index: the place of each tile in the file. A reader finds it from the end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sgicodec.bitstream.varint import encode_varint

_OFFSET_BYTES = 8


class Place(NamedTuple):
    """Where a chunk begins in the file, and the length of its payload."""

    offset: int
    length: int


def encode_index(places: Sequence[Place], offset: int) -> bytes:
    """The payload for tiles 0, 1, … of an index that begins at `offset`."""
    fields = [len(places), *(number for place in places for number in place)]
    return b"".join(map(encode_varint, fields)) + offset.to_bytes(_OFFSET_BYTES, "little")
