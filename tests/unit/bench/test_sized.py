"""Codecs brought to a size: whole bytes by a search, never above what is allowed, and a note where none fits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.bench.codec import Pixels8, RoundTrip
from sgicodec.bench.peers import Jpeg
from sgicodec.bench.run import Sample
from sgicodec.bench.sized import best_within, coded_to_size
from sgicodec.errors import SgiError, UsageError

pytest.importorskip("PIL")


def sample(height: int = 96, width: int = 128) -> Sample:
    y, x = np.mgrid[:height, :width]
    planes = [128 + 90 * np.sin(x / 17 + k) * np.cos(y / (11 + k)) + 40 * (x + 2 * y > 150) for k in range(3)]
    grain = np.random.default_rng(1).normal(0, 12, (height, width, 1))
    return Sample("p.png", "0123abcd", np.clip(np.stack(planes, axis=2) + grain, 0, 255).astype(np.uint8))


@given(st.lists(st.integers(0, 1000), min_size=1).map(sorted), st.integers(0, 1000))
def test_the_search_finds_the_last_that_fits(sizes: list[int], limit: int) -> None:
    fitting = [index for index, size in enumerate(sizes) if size <= limit]
    assert best_within(range(len(sizes)), sizes.__getitem__, limit) == max(fitting, default=None)


def test_a_codec_that_cannot_go_so_low_says_what_it_needs() -> None:
    least = len(Jpeg().encode(sample().pixels, 1))
    found = coded_to_size(Jpeg(), sample(), 300)
    assert (found.codec, found.bytes, found.pixels, found.note) == ("jpeg", least, None, f"needs {least:,} bytes")


class Fixed:
    """A codec with qualities alone."""

    name, ladder = "fixed", (1.0,)

    def version(self) -> str:
        return "1"

    def settings(self, quality: float) -> str:
        return "none"

    def round_trip(self, pixels: Pixels8, quality: float) -> RoundTrip:
        raise AssertionError("asked for a quality")


class Meeting(Fixed):
    """A codec that has a target of its own, as sgi has, and fails below ten bytes."""

    def of_size(self, pixels: Pixels8, size: int) -> RoundTrip:
        if size < 10:
            raise SgiError("too small")
        return RoundTrip(b"x" * size, pixels, 1.0, 1.0)


def test_a_codec_with_targets_is_asked_for_the_size() -> None:
    found = coded_to_size(Meeting(), sample(), 777)
    assert (found.bytes, found.note) == (777, "")
    failed = coded_to_size(Meeting(), sample(), 7)
    assert (failed.pixels, failed.note) == (None, "too small")


def test_a_codec_without_sizes_is_refused() -> None:
    with pytest.raises(UsageError, match="fixed cannot be asked for a size"):
        coded_to_size(Fixed(), sample(), 777)
