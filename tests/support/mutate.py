"""Changes streams where their structure is, and makes the checksums fit again: what a forger does, at random."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from absurd import absurd_stream
from page_varint import decode_varint
from surgery import Parts, join, split, with_fields

from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.header import decode_header
from sgicodec.bitstream.varint import encode_varint
from sgicodec.errors import SgiError

Random = np.random.Generator

_FIELDS = (
    *("width", "height", "channels", "layout", "sample_type", "seed_layout", "flags", "per_seed"),
    *("features", "hidden", "base_cell", "quality", "family", "prior", "context_hidden", "neighbours"),
)
_DEEP = 3
"""Overviews in overviews that are changed, too."""


def mutated(data: bytes, others: list[bytes], rng: Random, deep: int = 0) -> bytes:
    """One or a few changes of a stream: of its bytes, fields, chunks, tiles, masks, index, overview or payloads."""
    if rng.random() < 0.05:
        return absurd_stream(rng)
    try:
        return _changed(data, others, rng, deep)
    except (SgiError, IndexError, ValueError):  # what an earlier change left cannot be taken apart
        return _scrambled(data, rng)


def _changed(data: bytes, others: list[bytes], rng: Random, deep: int) -> bytes:
    parts = split(data)
    changes: list[Callable[[], bytes]] = [
        lambda: _scrambled(data, rng),
        lambda: _with_other_fields(data, rng),
        lambda: join([(letter, _scrambled(body, rng) if rng.random() < 0.4 else body) for letter, body in parts]),
        lambda: join(_spliced(parts, _parts_of(others, rng), rng)),
        lambda: join(_with_tile(parts, rng)),
        lambda: join(_with_tile(_parts_of([_with_other_fields(data, rng)], rng), rng)),
        lambda: join(_with_index(parts, rng)),
        lambda: join(_with_overview(parts, others, rng, deep)),
        lambda: join(_with_extra_header(parts, rng)),
    ]
    return changes[int(rng.integers(len(changes)))]()


def _parts_of(streams: list[bytes], rng: Random) -> Parts:
    """The chunks of one of the streams."""
    return split(streams[int(rng.integers(len(streams)))])


def _scrambled(data: bytes, rng: Random) -> bytes:
    """Flips, overwrites, cuts, repeats or inserts at one to four places."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 5))):
        at, length = int(rng.integers(len(changed) + 1)), int(rng.geometric(0.2))
        kind = int(rng.integers(6))
        noise = bytes(rng.integers(0, 256, length, np.uint8))
        if kind == 0 and at < len(changed):
            changed[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            changed[at : at + length] = noise[: len(changed) - at]
        elif kind == 2:
            del changed[at : at + length]
        elif kind == 3:
            changed[at:at] = changed[at : at + length]
        elif kind == 4:
            del changed[at:]
        else:
            changed[at:at] = noise
    return bytes(changed)


def _number(rng: Random) -> int:
    """Likelier small, or near a power of two."""
    near = 1 << int(rng.integers(0, 30))
    return max(0, near + int(rng.integers(-1, 2))) if rng.random() < 0.5 else int(rng.integers(0, near + 1))


def _with_other_fields(data: bytes, rng: Random) -> bytes:
    chosen = rng.choice(_FIELDS, min(6, int(rng.geometric(0.5))), replace=False)
    return with_fields(data, **{str(name): _number(rng) for name in chosen})


def _with_extra_header(parts: Parts, rng: Random) -> Parts:
    """The varints at the end of the header anew: hash grid, tile size and apron."""
    (letter, header), *rest = parts
    cut = int(rng.integers(1, 5))
    numbers = b"".join(encode_varint(_number(rng)) for _ in range(int(rng.integers(0, 5))))
    return [(letter, header[:-cut] + numbers), *rest]


def _spliced(parts: Parts, others: Parts, rng: Random) -> Parts:
    """Chunks of two streams, some lost, some swapped."""
    mixed = [part if rng.random() < 0.6 or not others else others[int(rng.integers(len(others)))] for part in parts]
    if rng.random() < 0.3:
        i, j = rng.integers(len(mixed), size=2)
        mixed[i], mixed[j] = mixed[j], mixed[i]
    return [part for part in mixed if rng.random() < 0.95]


def _with_tile(parts: Parts, rng: Random) -> Parts:
    """Another number, kind, mask or model of one tile."""
    tiles = [at for at, (letter, _) in enumerate(parts) if letter == "T"]
    if not tiles:
        return parts
    at = tiles[int(rng.integers(len(tiles)))]
    payload, number, mask = parts[at][1], b"", b""
    try:
        header = decode_header(parts[0][1])
        if header.tile:
            value, start = decode_varint(payload)
            number, payload = encode_varint(_number(rng) if rng.random() < 0.2 else value), payload[start:]
        if header.masked:
            kind, start = decode_varint(payload)
            payload = payload[start:]
            length, start = decode_varint(payload) if kind == 2 else (0, 0)
            mask, payload = payload[start : start + length], payload[start + length :]
            kind = int(rng.integers(4)) if rng.random() < 0.3 else kind
            mask = _payload(mask, rng) if rng.random() < 0.5 else mask
            mask = encode_varint(kind) + (encode_varint(len(mask)) + mask if kind == 2 else b"")
    except SgiError:
        pass
    model = _payload(payload, rng) if rng.random() < 0.7 else payload
    return [*parts[:at], ("T", number + mask + model), *parts[at + 1 :]]


def _payload(payload: bytes, rng: Random) -> bytes:
    """A range-coded payload that says something else: changed, cut (zeros follow for ever), or noise."""
    kind = int(rng.integers(4))
    if kind == 0:
        return _scrambled(payload, rng).rstrip(b"\0")
    if kind == 1:
        return payload[: int(rng.integers(len(payload) + 1))].rstrip(b"\0")
    if kind == 2:
        return bytes(rng.integers(0, 256, int(rng.integers(0, 400)), np.uint8)).rstrip(b"\0")
    return b"\xff" * int(rng.integers(0, 40))


def _with_index(parts: Parts, rng: Random) -> Parts:
    """An index with other numbers, whose own place may be right."""
    body = [part for part in parts if part[0] not in "XE"]
    at = len(join(body))
    count = int(rng.integers(0, 9)) if rng.random() < 0.5 else sum(letter == "T" for letter, _ in body)
    fields = [count, *(_number(rng) % (2 * at) for _ in range(2 * count))]
    place = at if rng.random() < 0.8 else _number(rng)
    return [*body, ("X", b"".join(map(encode_varint, fields)) + place.to_bytes(8, "little")), ("E", b"")]


def _with_overview(parts: Parts, others: list[bytes], rng: Random, deep: int) -> Parts:
    """An overview that is another stream, or the old one changed."""
    old = [body for letter, body in parts if letter == "o"]
    overview = old[0] if old and rng.random() < 0.7 else others[int(rng.integers(len(others)))]
    if deep < _DEEP and overview.startswith(SIGNATURE) and rng.random() < 0.6:
        overview = mutated(overview, others, rng, deep + 1)
    (first, *rest) = [part for part in parts if part[0] != "o"]
    return [first, ("o", overview), *rest]
