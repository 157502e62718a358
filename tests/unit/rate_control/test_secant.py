"""How corrections are sized, on tiles whose response is known."""

from __future__ import annotations

import math

import pytest

from sgicodec.rate_control.secant import REFIT, SEARCH

EVEN = dict.fromkeys(range(40), 10.0)


def test_little_is_asked_of_few_tiles() -> None:
    octaves, numbers = SEARCH.next(0.01, EVEN, list(EVEN), [])
    assert octaves == 0.35
    assert len(numbers) == math.ceil(40 * 1.3 * 0.01 / 0.2 / 0.35)
    assert len(set(numbers)) == len(numbers)
    octaves, numbers = REFIT.next(-0.05, EVEN, list(EVEN), [])
    assert octaves == -0.5
    assert len(numbers) == math.ceil(40 * 1.1 * 0.05 / 0.6 / 0.5)


def test_much_is_asked_of_all() -> None:
    assert SEARCH.next(0.1, EVEN, list(EVEN), []) == (pytest.approx(1.3 * 0.1 / 0.2), list(EVEN))
    assert SEARCH.next(9.0, EVEN, list(EVEN), []) == (4.0, list(EVEN))
    assert REFIT.next(-9.0, EVEN, list(EVEN), [])[0] == -2.0


def test_tiles_that_were_not_corrected_come_first() -> None:
    octaves, numbers = SEARCH.next(0.01, EVEN, range(20, 40), [(0.35, 0.02)])
    assert octaves == 0.35
    assert set(numbers) <= set(range(20, 40))
    assert len(numbers) == math.ceil(20 * 1.3 * 0.01 / 0.2 / 0.35 * 2)


@pytest.mark.parametrize("slope", [0.1, 0.3])
def test_a_straight_response_is_found(slope: float) -> None:
    """Two tries tell it; the third is where nothing is left to need."""
    need, tried = 0.2, list[tuple[float, float]]()
    for _ in range(3):
        octaves, _ = SEARCH.next(need, EVEN, list(EVEN) if not tried else [], tried)
        tried.append((octaves, need - slope * octaves))
    assert tried[-1][1] == pytest.approx(0.0, abs=1e-9)


def test_a_correction_that_gains_too_much_goes_back_past_the_fits() -> None:
    """RDOQ of every tile alone saves more than is needed: λ must fall below that of the fits."""
    saved, need = 0.12, 0.01
    octaves, numbers = SEARCH.next(need, EVEN, [], [(0.35, need - saved - 0.2 * 0.35)])
    assert -0.35 <= octaves < 0
    assert numbers == list(EVEN)
