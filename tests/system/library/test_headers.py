"""What libsgi tells of streams: from their first bytes, in structures of any version."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest
from data_files import GOLDEN_STREAMS
from library import NEEDS_COMPILER, Info, Library, LibraryError, View

import sgicodec

pytestmark = NEEDS_COMPILER

ELSEWHERE = {"has_overview", "file_bytes"}
"""What does not stand in a header."""


def fields(info: Info, without: frozenset[str] | set[str] = frozenset()) -> dict[str, object]:
    return {name: getattr(info, name) for name, _ in Info._fields_ if name not in without}


def refusal(library: Library, data: bytes) -> tuple[str, str] | None:
    """How first bytes are refused; None if they are not."""
    try:
        library.probe(data)
    except LibraryError as error:
        return error.status, str(error)
    return None


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_the_first_bytes_tell_what_the_header_says(path: Path, library: Library) -> None:
    """From as many bytes as the header has on; with fewer, that more are needed."""
    data = path.read_bytes()
    whole = fields(library.open(data).info(), ELSEWHERE)
    with sgicodec.open(path) as stream:
        first = stream.chunk_bytes["signature"] + stream.chunk_bytes["H"]
    for count in range(first):
        assert refusal(library, data[:count]) == ("source", f"the first {count} bytes do not hold the whole header")
    found = library.probe(data[:first])
    assert fields(found, ELSEWHERE) == whole
    assert (found.has_overview, found.file_bytes) == (0, 0)
    assert fields(library.probe(data), ELSEWHERE) == whole


@pytest.mark.parametrize(
    ("data", "status", "text"),
    [
        (b"", "source", "the first 0 bytes"),
        (b"\x89PNG\r\n\x1a\n" + bytes(40), "corrupt", "this is a PNG file"),
        (b"\x01\xda\x01\x01" + bytes(40), "corrupt", "Silicon Graphics"),
        (b"\x89SGI\r\n\x1a\nZ" + bytes(40), "corrupt", "a file starts with its one header"),
        (b"\x89SGI\r\n\x1a\nH\xff\xff\xff\xff\x7f" + bytes(9), "limit", "are allowed here"),
    ],
)
def test_first_bytes_of_something_else(data: bytes, status: str, text: str, library: Library) -> None:
    with pytest.raises(LibraryError, match=text) as caught:
        library.probe(data)
    assert caught.value.status == status


class LaterInfo(ctypes.Structure):
    """sgi_info as a later version may have it."""

    _fields_ = (("now", Info), ("later", ctypes.c_uint64 * 3))


class LaterView(ctypes.Structure):
    """sgi_view as a later version may have it."""

    _fields_ = (("now", View), ("later", ctypes.c_uint64 * 3))


def test_a_program_may_know_a_later_version(library: Library) -> None:
    """Fields that the library does not know are 0 when it fills them, and must be 0 when it reads them."""
    handle = library.open(GOLDEN_STREAMS[0].read_bytes())
    info = LaterInfo(Info(ctypes.sizeof(LaterInfo)), (7, 7, 7))
    library.call("sgi_get_info", handle.stream, ctypes.byref(info))
    assert (info.now.struct_size, *info.later) == (ctypes.sizeof(LaterInfo), 0, 0, 0)
    assert fields(info.now, {"struct_size"}) == fields(handle.info(), {"struct_size"})
    buffer = (ctypes.c_float * (info.now.width * info.now.height * info.now.channels))()
    stride = ctypes.c_size_t(4 * info.now.width * info.now.channels)
    for later in (0, 1):
        view = LaterView(handle.view(sample=2), (0, 0, later))
        view.now.struct_size = ctypes.sizeof(LaterView)
        call = ("sgi_draw", handle.stream, ctypes.byref(view), buffer, stride)
        if later:
            with pytest.raises(LibraryError, match="does not know"):
                library.call(*call)
        else:
            library.call(*call)


def test_a_program_may_know_an_earlier_version(library: Library) -> None:
    """One that ends behind `no_dither` draws the channels, in all rows."""
    handle = library.open(GOLDEN_STREAMS[0].read_bytes())
    shown = handle.draw(sample=2)
    view = handle.view(sample=2, pixels=1, row_count=1)
    view.struct_size = View.no_dither.offset + View.no_dither.size
    rows = ctypes.create_string_buffer(shown.nbytes)
    library.call("sgi_draw", handle.stream, ctypes.byref(view), rows, ctypes.c_size_t(shown.strides[0]))
    assert rows.raw == shown.tobytes()
