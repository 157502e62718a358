"""Takes streams apart and puts them together again, with checksums that fit: what a forger does."""

from __future__ import annotations

import zlib
from collections.abc import Callable

from page_varint import decode_varint

from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.varint import encode_varint

Parts = list[tuple[str, bytes]]
"""Letter and payload of every chunk."""

HEADER_FIELDS = (
    *("version", "width", "height", "channels", "layout", "sample_type", "profile", "seed_layout", "flags"),
    *("per_seed", "features", "hidden", "base_cell", "quality", "family"),
    *("prior", "context_hidden", "neighbours", "levels"),
)
"""The varints that every header starts with (docs/format.md); resolutions and the rest of the hash grid follow."""


def split(data: bytes) -> Parts:
    """The chunks of a sound stream."""
    parts, at = [], len(SIGNATURE)
    while at < len(data):
        length, start = decode_varint(data, at + 1)
        parts.append((chr(data[at]), data[start : start + length]))
        at = start + length + 4
    return parts


def frame(letter: str, payload: bytes, length: int | None = None) -> bytes:
    """A chunk with the CRC of what it holds, or one that lies about its length."""
    body = letter.encode("latin-1") + encode_varint(len(payload) if length is None else length) + payload
    return body + zlib.crc32(body).to_bytes(4, "little")


def join(parts: Parts) -> bytes:
    """A stream of these chunks."""
    return SIGNATURE + b"".join(frame(letter, payload) for letter, payload in parts)


def with_fields(data: bytes, **changes: int | Callable[[int], int]) -> bytes:
    """The stream with other header fields."""
    (_, header), *others = split(data)
    values, rest = _read(header)
    for name, change in changes.items():
        index = HEADER_FIELDS.index(name)
        values[index] = change if isinstance(change, int) else change(values[index])
    return join([("H", b"".join(map(encode_varint, values)) + rest), *others])


def with_hash(data: bytes, resolutions: list[int], features: int, log2_entries: int) -> bytes:
    """The stream with another hash grid."""
    (_, header), *others = split(data)
    values, _ = _read(header)
    grid = [*values[:-1], len(resolutions), *resolutions, features, log2_entries]
    return join([("H", b"".join(map(encode_varint, grid))), *others])


def flipped(data: bytes, bit: int) -> bytes:
    """The bytes with bit `bit` inverted."""
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def _read(header: bytes) -> tuple[list[int], bytes]:
    """The values of HEADER_FIELDS, and what follows."""
    values, at = [], 0
    for _ in HEADER_FIELDS:
        value, at = decode_varint(header, at)
        values.append(value)
    return values, header[at:]
