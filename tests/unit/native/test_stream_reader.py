"""The native reader of chunks: what a stream holds, from every kind of source, and what it makes of forged ones."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pytest
from data_files import GOLDEN_STREAMS
from mutate import mutated
from pipe import Counted, trickle
from surgery import Parts, frame, join, split

from sgicodec import _native
from sgicodec.device import ONE_THREAD
from sgicodec.errors import CorruptStreamError, LimitError, SgiError, StreamError, UnsupportedStreamError

STREAMS = [path.read_bytes() for path in GOLDEN_STREAMS]
TILED = next(path for path in GOLDEN_STREAMS if path.stem == "rgb8-tiles").read_bytes()
TILES = [payload for letter, payload in split(TILED) if letter == "T"]

Source = Callable[[bytes], bytes | BinaryIO]


def in_the_middle(data: bytes) -> BinaryIO:
    """A file that stands where the stream begins."""
    file = io.BytesIO(b"before" + data)
    file.seek(6)
    return file


def native_reader(source: bytes | BinaryIO) -> _native.Stream:
    """One that keeps no decoded tile."""
    return _native.Stream(source, 1, ONE_THREAD.isa, 0)


SOURCES: list[Source] = [bytes, io.BytesIO, in_the_middle, trickle]


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_all_chunks_are_found_from_every_source(path: Path, source: Source) -> None:
    data = path.read_bytes()
    parts = split(data)
    reader = native_reader(source(data))
    tiles = [payload for letter, payload in parts if letter == "T"]
    assert [reader.tile(number) for number in range(len(tiles))] == tiles
    blobs = {letter: payload for letter, payload in parts if letter not in "TXorE"}
    assert {letter: payload for letter, payload in reader.blobs.items() if letter in blobs} == blobs
    sizes: dict[str, int] = {}
    for letter, payload in parts:
        sizes[letter] = sizes.get(letter, 0) + len(frame(letter, payload))
    told = "HTorsx" if source is trickle else "HTXorsx"  # who cannot seek passes over the index
    assert {letter: reader.chunk_bytes.get(letter) for letter in told} == {name: sizes.get(name) for name in told}
    assert (reader.size, reader.has_overview) == (len(data), "o" in sizes)


def read_tiles(data: bytes, source: Source) -> list[bytes | None] | type[SgiError]:
    """The tiles of the tiled stream, None for those that are refused, or the kind of error of all."""
    try:
        reader = native_reader(source(data))
    except StreamError as error:
        return type(error)
    found: list[bytes | None] = []
    for number in range(len(TILES)):
        try:
            found.append(reader.tile(number))
        except StreamError:
            found.append(None)
    return found


def test_mutated_streams_are_judged_alike_from_bytes_and_files() -> None:
    rng = np.random.default_rng(3)
    endings = set()
    for _ in range(250):
        data = mutated(STREAMS[int(rng.integers(len(STREAMS)))], STREAMS, rng)
        outcomes = []
        for source in SOURCES[:3]:
            try:
                reader = native_reader(source(data))
                outcomes.append((None, str(reader.chunk_bytes), reader.size))
            except StreamError as error:
                outcomes.append((type(error), str(error), 0))
        assert outcomes[0] == outcomes[1] == outcomes[2]
        endings.add(outcomes[0][0])
    assert endings >= {None, CorruptStreamError, LimitError}


BODIES = (
    *(b"", b"\4", b"\x80" * 12, b"\x80" * 70000, b"\4" + b"\x80" * 12 + b"\1", b"\4\x80\0", b"\5" + b"\1" * 10),
    *(b"\4" + b"\xff" * 8 + b"\x3f" + b"\1" * 7, b"\4" + b"\1" * 8, b"\4" + b"\1" * 7 + b"\x81"),
)


@pytest.mark.parametrize("source", SOURCES)
def test_a_forged_index_leads_to_no_other_tile(source: Source) -> None:
    """A pipe finds all tiles one by one; who can seek reads the right ones or none."""
    before = join([part for part in split(TILED) if part[0] not in "XE"])
    for body in BODIES:
        for end in (len(before).to_bytes(8, "little"), b""):
            found = read_tiles(before + frame("X", body + end) + frame("E", b""), source)
            if isinstance(found, list):
                assert all(tile in (right, None) for tile, right in zip(found, TILES, strict=True)), body
            else:
                assert found in (CorruptStreamError, LimitError), body
            assert source is not trickle or found == TILES


def orders() -> dict[str, tuple[Parts, object]]:
    """The chunks of the tiled stream in other orders, and what docs/format.md ("Chunks", "Index") says of each."""
    parts = [part for part in split(TILED) if part[0] != "X"]
    head, tiles, end = parts[:3], parts[3:-1], parts[-1]
    blob, damaged = ("x", b"<x/>"), CorruptStreamError
    return {
        "without an index": (parts, TILES),
        "in another order": ([*head, *tiles[::-1], end], TILES),
        "metadata": ([head[0], blob, *parts[1:]], TILES),
        "unknown": ([head[0], ("q", b"?"), *parts[1:]], TILES),
        "unknown and required": ([head[0], ("Q", b"?"), *parts[1:]], UnsupportedStreamError),
        "metadata twice": ([head[0], blob, blob, *parts[1:]], damaged),
        "metadata behind tiles": ([*head, *tiles, blob, end], damaged),
        "header twice": ([head[0], *parts], damaged),
        "header behind all": ([*head, *tiles, head[0], end], damaged),
        "no header": (parts[1:], damaged),
        "no tile": ([head[0], end], damaged),
        "a tile lost": ([*head, *tiles[:-1], end], damaged),
        "a tile twice": ([*head, *tiles, tiles[1], end], damaged),
        "overviews": ([*head, head[2], *tiles, end], damaged),
        "an overview behind tiles": ([*head[:2], *tiles, head[2], end], damaged),
    }


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("name", orders())
def test_chunks_out_of_place(name: str, source: Source) -> None:
    parts, expected = orders()[name]
    assert read_tiles(join(parts), source) == expected


def test_a_tile_and_an_index_are_one_read_each() -> None:
    """What a source far away is asked for: the start, the end, the index, then each tile as a whole."""
    file = Counted(TILED)
    reader = native_reader(file)
    assert len(file.reads) <= 4
    file.reads.clear()
    assert [reader.tile(number) for number in range(len(TILES))] == TILES
    assert len(file.reads) == len(TILES)
