"""What libsgi makes of arguments, errors and threads."""

from __future__ import annotations

import ctypes
import threading

import numpy as np
import pytest
from library import NEEDS_COMPILER, Info, Library, LibraryError, Options, golden

pytestmark = NEEDS_COMPILER


WRONG_VIEWS = [
    ({"x": float("nan")}, "region", "too far away"),
    ({"width": float("inf")}, "region", "too far away"),
    ({"x": -1e300, "boundless": 1}, "region", "too far away"),
    ({"width": 0}, "region", "holds no picture"),
    ({"height": -4}, "region", "holds no picture"),
    ({"x": 1}, "region", r"region 1,0,192,128 is not inside the picture of 192×128 pixels"),
    ({"y": -0.5, "height": 20}, "region", "is not inside"),
    ({"width": 1e-300, "columns": 5}, "region", "is too small"),
    ({"columns": 0}, "usage", "no columns or no rows"),
    ({"rows": 0}, "usage", "no columns or no rows"),
    ({"columns": 2**32 - 1, "rows": 2**32 - 1}, "usage", "too many for one call"),
    ({"columns": 2**24 + 1, "rows": 1}, "usage", "too many for one call"),
    ({"columns": 2**16, "rows": 2**16}, "usage", "too many for one call"),
    ({"sample": 3}, "usage", "no sgi_sample"),
    ({"sample": -1}, "usage", "no sgi_sample"),
    ({"pixels": 3}, "usage", "no sgi_pixels"),
    ({"pixels": -1}, "usage", "no sgi_pixels"),
    ({"premultiplied": 1}, "usage", "goes with RGBA and BGRA"),
    ({"first_row": 128}, "usage", "rows that the view lacks"),
    ({"first_row": 100, "row_count": 29}, "usage", "rows that the view lacks"),
    ({"first_row": 2**32 - 1, "row_count": 2}, "usage", "rows that the view lacks"),
    ({"row_count": 129}, "usage", "rows that the view lacks"),
]


@pytest.mark.parametrize(("fields", "status", "text"), WRONG_VIEWS)
def test_views_that_make_no_sense_are_refused(
    library: Library, fields: dict[str, float], status: str, text: str
) -> None:
    handle, buffer = library.open(golden("rgb8")), np.zeros(1 << 16, np.float32)
    with pytest.raises(LibraryError, match=text) as caught:
        handle.draw_into(handle.view(**fields), buffer.ctypes.data, 2**40)
    assert caught.value.status == status
    assert not buffer.any()


@pytest.mark.parametrize(
    ("sample", "address", "stride", "text"),
    [
        (0, 0, 192 * 3 - 1, "a stride of 575 bytes; a row takes 576"),
        (1, 0, 192 * 3, "a row takes 1152"),
        (2, 0, 0, "a row takes 2304"),
        (1, 1, 2000, "multiples of the size of a sample"),
        (2, 2, 4000, "multiples of the size of a sample"),
        (2, 0, 4002, "multiples of the size of a sample"),
        (0, 0, 2**63 - 1, "larger than memory can be"),
        (0, 0, 2**64 - 1, "larger than memory can be"),
        (0, None, 576, "null pointer for the buffer"),
    ],
)
def test_buffers_that_make_no_sense_are_refused(
    library: Library, sample: int, address: int | None, stride: int, text: str
) -> None:
    handle, buffer = library.open(golden("rgb8")), np.zeros(1 << 16, np.float64)
    start = None if address is None else buffer.ctypes.data + address
    with pytest.raises(LibraryError, match=text) as caught:
        handle.draw_into(handle.view(sample=sample), start, stride)
    assert caught.value.status == "usage"
    assert not buffer.any()


def test_null_pointers_are_refused(library: Library) -> None:
    handle, data = library.open(golden("rgb8")), golden("rgb8")
    out, size, none = ctypes.c_void_p(5), ctypes.c_size_t(len(data)), ctypes.c_void_p()
    number = ctypes.c_uint32()
    calls = [
        ("sgi_open_memory", none, size, None, ctypes.byref(out)),
        ("sgi_open_memory", data, size, None, None),
        ("sgi_open", none, None, ctypes.c_uint64(5), None, ctypes.byref(out)),
        ("sgi_get_info", none, ctypes.byref(Info(ctypes.sizeof(Info)))),
        ("sgi_get_info", handle.stream, None),
        ("sgi_get_level", none, 0, ctypes.byref(number), ctypes.byref(number)),
        ("sgi_get_level", handle.stream, 0, None, ctypes.byref(number)),
        ("sgi_get_level", handle.stream, 0, ctypes.byref(number), None),
        ("sgi_get_range", none, 0, ctypes.byref(number), ctypes.byref(number)),
        ("sgi_get_range", handle.stream, 0, None, ctypes.byref(number)),
        ("sgi_get_range", handle.stream, 0, ctypes.byref(number), None),
        ("sgi_get_max_error", none, ctypes.byref(number)),
        ("sgi_get_max_error", handle.stream, None),
        ("sgi_get_exact_views", none, ctypes.byref(number)),
        ("sgi_get_exact_views", handle.stream, None),
        ("sgi_probe", none, size, ctypes.byref(Info(ctypes.sizeof(Info)))),
        ("sgi_probe", data, size, None),
        ("sgi_get_metadata", none, 0, ctypes.byref(out), ctypes.byref(size)),
        ("sgi_get_metadata", handle.stream, 0, None, ctypes.byref(size)),
        ("sgi_get_metadata", handle.stream, 0, ctypes.byref(out), None),
        ("sgi_draw", none, ctypes.byref(handle.view()), ctypes.byref(number), ctypes.c_size_t(576)),
        ("sgi_draw", handle.stream, None, ctypes.byref(number), ctypes.c_size_t(576)),
        ("sgi_verify", none, ctypes.byref(number)),
    ]
    for name, *arguments in calls:
        with pytest.raises(LibraryError, match="null pointer") as caught:
            library.call(name, *arguments)
        assert caught.value.status == "usage", name
    assert out.value is None
    library.c.sgi_close(None)
    library.call("sgi_verify", handle.stream, None)
    assert library.c.sgi_is_stream(None, ctypes.c_size_t(8)) == 0


def test_an_error_is_that_of_a_thread_until_its_next_call(library: Library) -> None:
    handle = library.open(golden("rgb8"))
    with pytest.raises(LibraryError):
        handle.level(9)
    elsewhere: list[bytes] = []
    thread = threading.Thread(target=lambda: elsewhere.append(library.c.sgi_error()))
    thread.start()
    thread.join()
    assert elsewhere == [b""]
    assert library.c.sgi_error() == b"level 9; there are 0 to 0"
    handle.info()
    assert library.c.sgi_error() == b""


def test_threads_share_a_handle_and_draw_the_same(library: Library) -> None:
    """Of eight threads half share one handle with little memory, the others have their own."""
    data = golden("rgb8-tiles")
    expected = library.open(data).draw()
    shared = library.open(data, Options(ctypes.sizeof(Options), 2, 1))
    failures: list[str] = []

    def draw(index: int) -> None:
        handle = shared if index % 2 else library.open(data, Options(ctypes.sizeof(Options), 1 + index % 3))
        for turn in range(4):
            y = 16 * ((index + turn) % 6)
            part = handle.draw(y=y, height=32, columns=192, rows=32)
            if not np.array_equal(part, expected[y : y + 32]):
                failures.append(f"{index}, {turn}")

    threads = [threading.Thread(target=draw, args=(index,)) for index in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
