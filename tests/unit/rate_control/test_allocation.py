"""The allocation of codings against all allocations there are."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.rate_control.allocation import Option, allocate

OPTIONS = st.lists(
    st.lists(st.builds(Option, st.integers(1, 50), st.integers(1, 50)), min_size=1, max_size=3), min_size=1, max_size=5
)


def totals(tiles: list[list[Option]], chosen: tuple[int, ...] | list[int]) -> tuple[float, float]:
    taken = [options[index] for options, index in zip(tiles, chosen, strict=True)]
    return sum(option.spent for option in taken), sum(option.cost for option in taken)


@given(OPTIONS, st.integers(1, 250))
def test_within_the_limit_wherever_anything_is(tiles: list[list[Option]], limit: int) -> None:
    """Never above a limit that can be kept; above the least cost by no more than one tile makes."""
    spent, cost = totals(tiles, allocate(tiles, limit))
    everything = [totals(tiles, chosen) for chosen in product(*(range(len(options)) for options in tiles))]
    least = min(spent for spent, _ in everything)
    if least > limit:
        assert spent == least
        return
    assert spent <= limit
    best = min(cost for spent, cost in everything if spent <= limit)
    widest = max(max(o.cost for o in options) - min(o.cost for o in options) for options in tiles)
    assert best <= cost <= best + widest


def test_what_is_left_is_spent() -> None:
    tiles = [[Option(10, 9), Option(20, 1)], [Option(10, 9), Option(12, 8)]]
    assert allocate(tiles, 20) == [0, 0]
    assert allocate(tiles, 22.5) == [0, 1]
    assert allocate(tiles, 30) == [1, 0]
    assert allocate(tiles, 100) == [1, 1]
    assert allocate(tiles, 3) == [0, 0]


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_units_do_not_matter(scale: float) -> None:
    tiles = [[Option(100 + n, scale * 50), Option(150 - n, scale * (20 + n))] for n in range(20)]
    spent, _ = totals(tiles, allocate(tiles, 2500))
    assert 2450 < spent <= 2500
