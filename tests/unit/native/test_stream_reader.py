"""The native reader of chunks against one from docs/format.md: equal payloads, equal errors of damaged streams."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pytest
from mutate import mutated
from page_stream import StreamReader, StreamSummary
from pipe import trickle
from surgery import flipped, frame, join, split

from sgicodec import _native
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.header import decode_header
from sgicodec.bitstream.index import Place, encode_index
from sgicodec.device import ONE_THREAD
from sgicodec.errors import CorruptStreamError, LimitError, SgiError

GOLDEN = sorted((Path(__file__).parents[2] / "conformance" / "golden").glob("*.sgi"))
STREAMS = [path.read_bytes() for path in GOLDEN]
TILED = next(path for path in GOLDEN if path.stem == "rgb8-tiles").read_bytes()
SINGLE = next(path for path in GOLDEN if path.stem == "rgb8").read_bytes()

Source = Callable[[bytes], bytes | BinaryIO]


def in_the_middle(data: bytes) -> BinaryIO:
    """A file that stands where the stream begins."""
    file = io.BytesIO(b"before" + data)
    file.seek(6)
    return file


SOURCES: list[Source] = [bytes, io.BytesIO, in_the_middle, trickle]


def native_reader(source: bytes | BinaryIO) -> _native.Stream:
    """One that keeps no decoded tile."""
    return _native.Stream(source, 1, ONE_THREAD.isa, 0)


def outcome(reader: Callable[[bytes | BinaryIO], Any], source: bytes | BinaryIO) -> Any:
    """All that it says, or its error."""
    try:
        stream = reader(source)
    except SgiError as error:
        return type(error), str(error)
    facts = [stream.blobs, stream.chunk_bytes, stream.size, stream.has_overview]
    for number in range(min(16, decode_header(stream.blobs["H"]).grid.count)):
        try:
            facts.append(stream.tile(number))
        except SgiError as error:
            facts.append((type(error), str(error)))
    return facts


def overview(reader: Callable[[bytes | BinaryIO], Any], source: bytes | BinaryIO) -> Any:
    """The stream in chunk o, or the error."""
    stream = reader(source)
    try:
        shown = stream.overview
        return shown() if callable(shown) else stream.overview_bytes
    except SgiError as error:
        return type(error), str(error)


def summary(data: bytes | BinaryIO) -> Any:
    found = StreamSummary(data)
    return found.blobs, found.chunk_bytes, found.size


def told(summarize: Callable[[bytes | BinaryIO], Any], source: bytes | BinaryIO) -> Any:
    """What is said before the tiles, or the error."""
    try:
        return summarize(source)
    except SgiError as error:
        return type(error), str(error)


def check(data: bytes, source: Source = bytes) -> Any:
    """What both of them make of it."""
    assert told(_native.summarize, source(data)) == told(summary, source(data))
    found = outcome(native_reader, source(data))
    assert found == outcome(StreamReader, source(data))
    if isinstance(found, list) and found[3]:
        native, page = (overview(reader, source(data)) for reader in (native_reader, StreamReader))
        assert native == page or (isinstance(native, tuple) and isinstance(page, bytes))  # no overview of this picture
    return found


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden_streams_are_read_from_every_source(path: Path, source: Source) -> None:
    data = path.read_bytes()
    found = check(data, source)
    assert isinstance(found, list)
    tile = next(payload for letter, payload in split(data) if letter == "T")
    assert tile in found


@pytest.mark.parametrize("source", SOURCES)
def test_mutated_streams_are_judged_alike(source: Source) -> None:
    rng = np.random.default_rng(SOURCES.index(source))
    errors = set()
    for _ in range(250):
        data = mutated(STREAMS[int(rng.integers(len(STREAMS)))], STREAMS, rng)
        found = check(data, source)
        errors.add(found[0] if isinstance(found, tuple) else None)
    assert errors >= {None, CorruptStreamError, LimitError}


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("data", [SINGLE, TILED], ids=["single", "tiled"])
def test_flips_and_cuts_are_judged_alike(source: Source, data: bytes) -> None:
    rng = np.random.default_rng(7)
    bits = 8 * len(data)
    for bit in [*range(0, 400, 3), *rng.integers(0, bits, 60).tolist(), *range(bits - 150, bits)]:
        check(flipped(data, bit), source)
    for length in [*range(60), *rng.integers(0, len(data), 30).tolist(), *range(len(data) - 30, len(data))]:
        assert isinstance(check(data[:length], source), tuple)
    check(data + b"\0", source)


def with_index(payload: Callable[[int], bytes]) -> bytes:
    """The tiled stream with another index, whose payload follows from where it begins."""
    before = join([part for part in split(TILED) if part[0] not in "XE"])
    return before + frame("X", payload(len(before))) + frame("E", b"")


def places() -> list[Place]:
    found, at = [], len(SIGNATURE)
    for letter, payload in split(TILED):
        if letter == "T":
            found.append(Place(at, len(payload)))
        at += len(frame(letter, payload))
    return found


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"\4",
        b"\x80" * 12,
        b"\x80" * 70000,
        b"\4" + b"\x80" * 12 + b"\1",
        b"\4\x80\0",
        b"\5" + b"\1" * 10,
        b"\4" + b"\xff" * 8 + b"\x3f" + b"\1" * 7,
        b"\4" + b"\1" * 8,
        b"\4" + b"\1" * 7 + b"\x81",
    ],
)
def test_indexes_are_judged_alike(body: bytes) -> None:
    for source in SOURCES:
        check(with_index(lambda offset: body + offset.to_bytes(8, "little")), source)
        check(with_index(lambda offset: body), source)


def test_indexes_that_lie_are_judged_alike() -> None:
    right = places()
    assert isinstance(check(with_index(lambda offset: encode_index(right, offset))), list)
    swapped = [right[1], right[0], *right[2:]]
    far = [Place(2**62, right[0].length), *right[1:]]
    early = [Place(8, right[0].length), *right[1:]]
    for lie in (swapped, far, early, right[:-1]):
        for source in SOURCES:
            check(with_index(lambda offset, lie=lie: encode_index(lie, offset)), source)
    for shift in (-1, 1, 2**63):
        check(with_index(lambda offset, shift=shift: encode_index(right, offset + shift)))


def test_a_signature_that_was_altered_is_told_alike() -> None:
    starts = ["", "89534749", "89534749 0a1a0a", "89534749 0d0d0a1a", "89534749 0d1a0a", "09534749 0d0a1a0a"]
    starts += ["c2895347490d0a1a", "efbfbd534749", "ffd8ff", "89504e470d0a1a0a", "01da", "00"]
    for start in starts:
        for source in SOURCES:
            for tail in (b"", bytes(40)):
                assert isinstance(check(bytes.fromhex(start) + tail, source), tuple)


@pytest.mark.parametrize("source", SOURCES)
def test_chunks_out_of_place_are_judged_alike(source: Source) -> None:
    parts = split(TILED)
    blob = ("x", b"<x/>")
    orders = [
        [*parts[:1], *parts[2:]],
        [parts[0], blob, blob, *parts[1:]],
        [*parts[:-1], blob, parts[-1]],
        [parts[0], ("q", b"?"), *parts[1:]],
        [parts[0], ("Q", b"?"), *parts[1:]],
        [parts[0], *parts],
        parts[1:],
        [parts[0], ("E", b"")],
        [part for part in parts if part[0] != "X"],
        [*[part for part in parts if part[0] != "X"][:-2], ("E", b"")],
        [parts[0], ("o", SINGLE), ("o", SINGLE), *parts[1:]],
        [parts[0], ("o", SINGLE), *parts[1:]],
        [*parts[:-1], parts[0], parts[-1]],
    ]
    for order in orders:
        check(join(order), source)


def test_a_lying_length_takes_no_memory() -> None:
    for length in ("ffffffffffffffff7f", "8080808004", "ffffffff03"):
        for source in SOURCES:
            data = SIGNATURE + frame(*split(SINGLE)[0]) + b"s" + bytes.fromhex(length) + b"abc"
            assert isinstance(check(data, source), tuple)


def test_errors_of_a_file_come_through() -> None:
    class Broken(io.BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            raise OSError("the disk is gone")

    with pytest.raises(OSError, match="the disk is gone"):
        native_reader(Broken(SINGLE))


def test_a_tile_and_an_index_are_one_read_each() -> None:
    """What a source far away is asked for: the start, the end, the index, then each tile as a whole."""

    class Counted(io.BytesIO):
        def __init__(self, data: bytes) -> None:
            super().__init__(data)
            self.reads: list[tuple[int, int]] = []

        def read(self, size: int | None = -1, /) -> bytes:
            self.reads.append((self.tell(), size or 0))
            return super().read(size)

    file = Counted(TILED)
    reader = native_reader(file)
    assert len(file.reads) <= 4
    file.reads.clear()
    parts = [payload for letter, payload in split(TILED) if letter == "T"]
    assert [reader.tile(number) for number in range(len(parts))] == parts
    assert len(file.reads) == len(parts)
