"""How a fit's steps are counted, and what is due in their course."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.fit.schedule import Schedule, evenly, passed
from sgicodec.profiles.fit_settings import Phase


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4))
def test_counted_steps(counts: list[int]) -> None:
    schedule = Schedule(tuple(Phase(count) for count in counts))
    number = 0
    for index, count in enumerate(counts):
        fractions = []
        for fraction in schedule.within(index):
            assert schedule.done == pytest.approx(number / sum(counts))
            assert schedule.steps == sum(counts)
            number += 1
            fractions.append(fraction)
        assert fractions == [(i + 1) / count for i in range(count)]
    assert schedule.done == 1.0


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4), st.integers(0, 12))
def test_what_happens_evenly_is_due_once_each_unless_steps_are_too_few(counts: list[int], times: int) -> None:
    schedule = Schedule(tuple(Phase(count) for count in counts))
    for index, count in enumerate(counts):
        left = evenly(times)
        due = [fraction for fraction in schedule.within(index) if passed(left, fraction)]
        assert due == sorted({math.ceil((i + 1) / (times + 1) * count - 1e-9) / count for i in range(times)})
        assert left == []
