"""The search for a size: whole bytes, never above what is allowed."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from benchmarks._sizes import best_within


@given(st.lists(st.integers(0, 1000), min_size=1).map(sorted), st.integers(0, 1000))
def test_the_search_finds_the_last_that_fits(sizes: list[int], limit: int) -> None:
    fitting = [index for index, size in enumerate(sizes) if size <= limit]
    assert best_within(range(len(sizes)), sizes.__getitem__, limit) == max(fitting, default=None)
