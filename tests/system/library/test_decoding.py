"""libsgi draws and refuses what Python does."""

from __future__ import annotations

import ctypes
import threading
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN_STREAMS
from library import NEEDS_COMPILER, SAMPLES, Library, LibraryError, Options, Proceed, golden
from mutate import mutated

import sgicodec
from sgicodec.errors import CorruptStreamError, LimitError, SgiError, UnsupportedStreamError
from sgicodec.metadata.layouts import band_ranges
from sgicodec.picture import full_range

pytestmark = NEEDS_COMPILER


METADATA = {"icc": 0, "exif": 1, "xmp": 2, "geo": 3}


STATUS_OF = {CorruptStreamError: "corrupt", UnsupportedStreamError: "unsupported", LimitError: "limit"}


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_it_tells_and_draws_what_python_does(path: Path, library: Library) -> None:
    handle, info = library.open(path.read_bytes()), library.open(path.read_bytes()).info()
    with sgicodec.open(path) as stream:
        header = stream.header
        assert (info.width, info.height, info.channels) == (stream.width, stream.height, header.spec.channels)
        assert SAMPLES[info.sample] == header.sample_type
        ranges = [*band_ranges(header.sample_range, header.colours)]
        ranges += [full_range(stream.dtype)] * (info.channels - header.colours)
        found = [handle.range(channel) for channel in range(info.channels)]
        np.testing.assert_array_equal(found, np.array(ranges, np.float32))
        assert (info.low, info.high) == found[0]
        assert (info.tiles, info.tile_size) == (stream.grid.count, header.tile)
        assert info.has_nodata == (header.masked == "nodata")
        np.testing.assert_equal(info.nodata, header.nodata)
        assert handle.max_error() == (-1 if stream.max_error is None else stream.max_error)
        assert (info.has_overview, info.file_bytes) == (stream.has_overview, path.stat().st_size)
        assert [handle.level(level) for level in range(info.levels)] == [tuple(level[:2]) for level in stream.levels]
        for name, kind in METADATA.items():
            assert handle.metadata(kind) == getattr(stream.metadata, name)
        assert handle.verify() == stream.symbol_crc
        for dtype in SAMPLES:
            whole = handle.draw(sample=SAMPLES.index(dtype))
            np.testing.assert_array_equal(whole, stream.picture(dtype=dtype).pixels)
        x, y, width, height = min(5, info.width - 1), 0, max(1, info.width // 2 - 5), max(1, info.height // 3)
        for scale in (0.4, 1, 2.5):
            expected = stream.picture((x, y, width, height), scale=scale).pixels
            rows, columns = expected.shape[:2]
            size = {"x": x, "y": y, "width": width, "height": height, "columns": columns, "rows": rows}
            np.testing.assert_array_equal(handle.draw(padding=3, **size), expected)
        beyond = stream.picture((-3, -2, width + 9, height + 9), boundless=True).pixels
        size = {"x": -3, "y": -2, "width": width + 9, "height": height + 9}
        np.testing.assert_array_equal(handle.draw(boundless=1, **size), beyond)


@pytest.mark.parametrize("returned", [-1, -(2**63), 2**62])
@pytest.mark.parametrize("after", [0, 1, 3])
def test_a_callback_that_fails_is_an_error_of_the_source(library: Library, returned: int, after: int) -> None:
    data = golden("rgb8-tiles")
    calls = []

    def read(offset: int, count: int) -> bytes | int:
        calls.append(offset)
        return data[offset : offset + count] if len(calls) <= after else returned

    with pytest.raises(LibraryError, match=r"reading failed at byte \d+") as caught:
        library.open_callback(read, len(data)).draw()
    assert caught.value.status == "source"


def test_a_call_can_be_stopped(library: Library) -> None:
    data, calls = golden("rgb8-tiles"), []

    def proceed(_: int) -> int:
        calls.append(threading.get_ident())
        return len(calls) < stop

    stop = 10**9
    options = Options(ctypes.sizeof(Options), 0, 0, Proceed(proceed), None)
    expected = library.open(data, options).draw()
    assert len(calls) >= 2
    assert set(calls) == {threading.get_ident()}
    calls.clear()
    stop = 2
    handle = library.open(data, options)
    with pytest.raises(LibraryError, match="stopped") as caught:
        handle.draw()
    assert caught.value.status == "stopped"
    stop = 10**9
    np.testing.assert_array_equal(handle.draw(), expected)


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_a_tile_takes_no_more_than_it_may(path: Path, library: Library) -> None:
    """Enough changes nothing; too little is told, and less than that, too."""
    data = path.read_bytes()

    def draw(tile_bytes: int) -> np.ndarray:
        return library.open(data, Options(ctypes.sizeof(Options), tile_bytes=tile_bytes)).draw()

    expected = draw(0)
    for enough in (1 << 30, 2**64 - 1):
        np.testing.assert_array_equal(draw(enough), expected)
    for little in (1, 1000):
        with pytest.raises(LibraryError) as caught:
            draw(little)
        assert caught.value.status == "limit"


def outcome_in_python(data: bytes) -> tuple[str, str] | np.ndarray:
    try:
        with sgicodec.open(data) as stream:
            if stream.width * stream.height * stream.header.spec.channels > 1 << 22:
                return "large", ""
            # `picture` decodes tiles before it looks at the residual layer: of two damages it tells the other
            return np.concatenate([part.pixels for _, part in stream.bands()])
    except SgiError as error:
        return STATUS_OF[type(error)], str(error)


def outcome_in_c(library: Library, data: bytes) -> tuple[str, str] | np.ndarray:
    try:
        return library.open(data).draw()
    except LibraryError as error:
        return error.status, str(error)


def test_damaged_streams_are_told_as_in_python(library: Library) -> None:
    """The same samples, or the same kind of error with the same words."""
    streams, rng, seen = [path.read_bytes() for path in GOLDEN_STREAMS], np.random.default_rng(3), set()
    for _ in range(150):
        data = mutated(streams[int(rng.integers(len(streams)))], streams, rng)
        expected = outcome_in_python(data)
        if isinstance(expected, tuple) and expected[0] == "large":
            continue
        seen.add(expected[0] if isinstance(expected, tuple) else "ok")
        found = outcome_in_c(library, data)
        if isinstance(expected, tuple) or isinstance(found, tuple):
            assert found == expected
        else:
            np.testing.assert_array_equal(found, expected)
    assert seen >= {"ok", "corrupt", "limit"}
