"""Codecs brought to a size: whole bytes by a search, never above what is allowed, and a note where none fits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks._sized import best_within, coded_to_size
from sgicodec.bench.codec import Pixels8, RoundTrip
from sgicodec.bench.peers import PEERS
from sgicodec.bench.sgi import SgiCodec
from sgicodec.errors import SgiError

pytest.importorskip("PIL")


def picture(height: int = 96, width: int = 128) -> Pixels8:
    y, x = np.mgrid[:height, :width]
    planes = [128 + 90 * np.sin(x / 17 + k) * np.cos(y / (11 + k)) + 40 * (x + 2 * y > 150) for k in range(3)]
    grain = np.random.default_rng(1).normal(0, 12, (height, width, 1))
    return np.clip(np.stack(planes, axis=2) + grain, 0, 255).astype(np.uint8)


@given(st.lists(st.integers(0, 1000), min_size=1).map(sorted), st.integers(0, 1000))
def test_the_search_finds_the_last_that_fits(sizes: list[int], limit: int) -> None:
    fitting = [index for index, size in enumerate(sizes) if size <= limit]
    assert best_within(range(len(sizes)), sizes.__getitem__, limit) == max(fitting, default=None)


def test_a_codec_that_cannot_go_so_low_says_what_it_needs() -> None:
    least = len(PEERS["jpeg"].encode(picture(), 1))
    found = coded_to_size(PEERS["jpeg"], picture(), 300)
    assert (found.codec, found.bytes, found.pixels, found.note) == ("jpeg", least, None, f"needs {least:,} bytes")


class Meeting(SgiCodec):
    """Meets every size but those below ten bytes."""

    def trip(self, pixels: Pixels8, target: tuple[str, ...]) -> RoundTrip:
        name, size = target
        assert name == "--size"
        if int(size) < 10:
            raise SgiError("too small")
        return RoundTrip(b"x" * int(size), pixels, 1.0, 1.0)


def test_sgi_is_asked_for_the_size() -> None:
    found = coded_to_size(Meeting(), picture(), 777)
    assert (found.codec, found.bytes, found.note) == ("sgi", 777, "")
    failed = coded_to_size(Meeting(), picture(), 7)
    assert (failed.pixels, failed.note) == (None, "too small")
