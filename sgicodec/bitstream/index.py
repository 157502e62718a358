"""Chunk X, the index: the place of each tile in the file. A reader finds it from the end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from sgicodec.bitstream.varint import MAX_VARINT_BYTES, decode_varints, encode_varint
from sgicodec.errors import CorruptStreamError, LimitError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["TRAILER_BYTES", "Place", "check_unlisted", "decode_index", "encode_index", "index_offset", "longest_index"]

_END = bytes.fromhex("4500bfa9d7cc")
"""Chunk E."""

_OFFSET_BYTES, _CRC_BYTES = 8, 4
TRAILER_BYTES = _OFFSET_BYTES + _CRC_BYTES + len(_END)
"""Of a file with an index: where the index begins, its CRC, the end mark."""


_MOST_UNLISTED = 1 << 15
"""Tiles that are looked for one by one in a file without an index; every encoder writes one."""


class Place(NamedTuple):
    """Where a chunk begins in the file, and the length of its payload."""

    offset: int
    length: int


def encode_index(places: Sequence[Place], offset: int) -> bytes:
    """The payload for tiles 0, 1, … of an index that begins at `offset`."""
    fields = [len(places), *(number for place in places for number in place)]
    return b"".join(map(encode_varint, fields)) + offset.to_bytes(_OFFSET_BYTES, "little")


def decode_index(payload: bytes, count: int) -> NDArray[np.int64]:
    """Offset and length of the `count` tiles [count, 2]. Raises CorruptStreamError."""
    fields = decode_varints(payload[: max(0, len(payload) - _OFFSET_BYTES)])
    if len(payload) < _OFFSET_BYTES or len(fields) != 2 * count + 1 or fields[0] != count:
        raise CorruptStreamError(f"index: it does not list the {count} tiles; the file is damaged")
    return fields[1:].reshape(count, 2)


def check_unlisted(count: int) -> None:
    """Raises LimitError if n tiles are too many for a file without an index."""
    if count > _MOST_UNLISTED:
        raise LimitError(f"there are {count} tiles and no sound index; at most {_MOST_UNLISTED} are sought without one")


def longest_index(count: int) -> int:
    """Bytes that the payload of an index of n tiles cannot exceed."""
    return _OFFSET_BYTES + MAX_VARINT_BYTES * (2 * count + 1)


def index_offset(tail: bytes) -> int | None:
    """Where the index of a file that ends in these `TRAILER_BYTES` begins, if it has one."""
    if len(tail) != TRAILER_BYTES or not tail.endswith(_END):
        return None
    return int.from_bytes(tail[:_OFFSET_BYTES], "little")
