"""What is read of a remote file: the bytes that are there, few requests in a row, few bytes of a part."""

from __future__ import annotations

import io

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.remote.range_file import BLOCK, RangeFile

DATA = np.random.default_rng(3).integers(0, 256, 5 * BLOCK + 123, np.uint8).tobytes()


class Log:
    """The ranges that were fetched."""

    def __init__(self, data: bytes) -> None:
        self.data, self.ranges, self.calls = data, list[tuple[int, int]](), 0

    def __call__(self, spans: list[tuple[int, int]]) -> list[bytes]:
        self.ranges += spans
        self.calls += 1
        return [self.data[start:stop] for start, stop in spans]


@given(st.lists(st.tuples(st.integers(0, len(DATA) + 9), st.integers(0, 3 * BLOCK)), max_size=12))
def test_it_reads_what_a_file_holds(reads: list[tuple[int, int]]) -> None:
    log, other = Log(DATA), io.BytesIO(DATA)
    with RangeFile(len(DATA), log) as file:
        for offset, count in reads:
            assert file.seek(offset) == other.seek(offset)
            assert file.read(count) == other.read(count)
            assert file.tell() == other.tell()
    assert all(0 <= start < stop <= len(DATA) and start % BLOCK == 0 for start, stop in log.ranges)


def test_what_is_expected_is_fetched_at_once() -> None:
    data = bytes(range(256)) * (BLOCK // 8)  # 32 blocks
    log = Log(data)
    file = RangeFile(len(data), log)
    file.seek(4 * BLOCK)
    file.read(1)
    places = [
        (5, 10),
        (BLOCK + 5, BLOCK),
        (4 * BLOCK + 9, 20),
        (8 * BLOCK, 1),
        (10 * BLOCK, 1),
        (31 * BLOCK, 9 * BLOCK),
    ]
    file.expect(places)
    assert log.calls == 2
    assert log.ranges[1:] == [(0, 3 * BLOCK), (8 * BLOCK, 11 * BLOCK), (31 * BLOCK, 32 * BLOCK)]
    for offset, count in places:
        file.seek(offset)
        assert file.read(count) == data[offset : offset + count]
    file.expect([*places, (40 * BLOCK, 5)])
    assert log.calls == 2
