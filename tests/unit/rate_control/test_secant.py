"""How corrections are sized, on tiles whose response is known."""

from __future__ import annotations

import math

import pytest

from sgicodec.rate_control.secant import next_correction

EVEN = dict.fromkeys(range(40), 10.0)


@pytest.mark.parametrize(("coarser", "sign"), [(True, 1), (False, -1)])
def test_little_is_asked_of_few_tiles(coarser: bool, sign: int) -> None:
    octaves, numbers = next_correction(coarser, sign * 0.005, EVEN, list(EVEN), [])
    assert octaves == sign * 0.1
    assert len(numbers) == math.ceil(40 * 1.3 * 0.005 / 0.35 / 0.1)
    assert len(set(numbers)) == len(numbers)


def test_much_is_asked_of_all() -> None:
    assert next_correction(True, 0.1, EVEN, list(EVEN), []) == (pytest.approx(1.3 * 0.1 / 0.35), list(EVEN))
    assert next_correction(True, 9.0, EVEN, list(EVEN), []) == (4.0, list(EVEN))
    assert next_correction(False, -9.0, EVEN, list(EVEN), [])[0] == -4.0


def test_tiles_that_were_not_corrected_come_first() -> None:
    octaves, numbers = next_correction(True, 0.005, EVEN, range(20, 40), [(0.1, 0.02)])
    assert octaves == 0.1
    assert set(numbers) <= set(range(20, 40))
    assert len(numbers) == math.ceil(20 * 1.3 * 0.005 / 0.35 / 0.1 * 2)


@pytest.mark.parametrize("slope", [0.2, 0.5])
def test_a_straight_response_is_found(slope: float) -> None:
    """Two tries tell it; the third goes as far beyond as corrections do, a hundredth of an octave."""
    need, tried = 0.2, list[tuple[float, float]]()
    for _ in range(3):
        octaves, _ = next_correction(True, need, EVEN, list(EVEN) if not tried else [], tried)
        tried.append((octaves, need - slope * octaves))
    assert abs(tried[-1][1]) == pytest.approx(0.01, abs=1e-9)


def test_a_correction_that_gains_too_much_goes_back_past_the_fits() -> None:
    """A new search of every tile alone saves more than is needed: λ must fall below that of the fits."""
    saved, need = 0.12, 0.01
    octaves, numbers = next_correction(True, need, EVEN, [], [(0.1, need - saved - 0.35 * 0.1)])
    assert -0.1 <= octaves < 0
    assert numbers == list(EVEN)
