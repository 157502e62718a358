"""The native header against one that is read as docs/format.md says: equal fields; for damaged ones the same errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
import page_header
from data_files import GOLDEN_STREAMS
from hypothesis import given
from hypothesis import strategies as st
from surgery import join, split, with_fields

from sgicodec.bitstream.header import Header, decode_header
from sgicodec.errors import SgiError

PAYLOADS = [split(path.read_bytes())[0][1] for path in GOLDEN_STREAMS]


def outcome(decode: Callable[[bytes], Header], payload: bytes) -> Any:
    try:
        found = decode(payload)
    except SgiError as error:
        return type(error), str(error)
    return asdict(found)


def check(payload: bytes) -> None:
    np.testing.assert_equal(outcome(decode_header, payload), outcome(page_header.decode_header, payload))


@given(st.sampled_from(PAYLOADS), st.data())
def test_damaged_headers_are_judged_alike(payload: bytes, data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(payload) - 1))
    check(payload)
    check(payload[:at])
    check(payload[:at] + bytes([data.draw(st.integers(0, 255))]) + payload[at + 1 :])
    check(payload + data.draw(st.binary(min_size=1, max_size=12)))


@given(
    st.sampled_from(
        [
            p
            for p, path in zip(PAYLOADS, GOLDEN_STREAMS, strict=True)
            if path.stem in ("float", "gray16", "rgb8", "multi8")
        ]
    ),
    st.sampled_from([0, 4, 64, 68, 128, 132, 256, 324]),
    st.sampled_from([b"", b"\1", b"\2", b"\3", b"\5"]),
    st.one_of(
        st.binary(min_size=16, max_size=16),
        st.tuples(st.floats(width=32), st.floats(width=32), st.floats()).map(
            lambda numbers: np.array(numbers[:2], "<f4").tobytes() + np.array(numbers[2], "<f8").tobytes()
        ),
        st.floats().map(lambda number: np.array([number], "<f8").tobytes()),
        st.integers(-2, 65537).map(lambda number: np.array([number], "<f8").tobytes()),
        st.lists(st.sampled_from([0.0, 1.0, 9.0, 255.0, 4095.0, 65535.0]), min_size=2, max_size=10).map(
            lambda numbers: np.array(numbers, "<f4").tobytes()
        ),
    ),
)
def test_ranges_and_nodata_are_judged_alike(payload: bytes, flag: int, count: bytes, tail: bytes) -> None:
    """Whatever the numbers at a header's end are."""
    tail = count + tail
    changed = split(with_fields(join([("H", payload)]), flags=lambda flags: flags | flag))[0][1]
    at = len(changed) - 8 * (decode_header(payload).sample_type == "float32")
    check(changed[:at] + tail)
