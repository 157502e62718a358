"""How a fit's steps are shared out: counted, and by a clock that the test turns."""

from __future__ import annotations

import math

import pytest
from clock import Clock
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.fit.schedule import Schedule, evenly, passed
from sgicodec.profiles.fit_settings import Phase

PHASES = (Phase(3), Phase(15), Phase(2))


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4))
def test_counted_steps(counts: list[int]) -> None:
    schedule = Schedule(tuple(Phase(count) for count in counts), None)
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
    assert schedule.begun == sum(counts)


def test_the_clock_starts_with_the_first_step(clock: Clock) -> None:
    schedule = Schedule(PHASES, 10.0)
    clock.now += 500.0
    assert schedule.elapsed == 0.0
    next(schedule.within(0))
    clock.now += 2.0
    assert schedule.elapsed == 2.0


def run(schedule: Schedule, clock: Clock, seconds: tuple[float, ...]) -> list[list[float]]:
    """The fractions of each phase, where a step of phase i takes seconds[i]."""
    told = []
    for index, each in enumerate(seconds):
        fractions = []
        for fraction in schedule.within(index):
            clock.now += each
            fractions.append(fraction)
        told.append(fractions)
    return told


@pytest.mark.parametrize("each", [0.01, 0.13, 0.7])
def test_a_time_is_kept_and_shared_in_proportion(clock: Clock, each: float) -> None:
    schedule = Schedule(PHASES, 10.0)
    told = run(schedule, clock, (each,) * 3)
    assert 10.0 - each <= schedule.elapsed <= 10.0 + 2 * each
    for phase, fractions in zip(PHASES, told, strict=True):
        assert fractions == sorted(fractions)
        assert fractions[-1] == 1.0
        assert len(fractions) * each == pytest.approx(10.0 * phase.steps / 20, abs=2 * each)
    assert schedule.done == 1.0


def test_every_phase_has_a_step_where_there_is_no_time(clock: Clock) -> None:
    schedule = Schedule(PHASES, 1e-3)
    assert run(schedule, clock, (5.0, 5.0, 5.0)) == [[0.0, 1.0], [1.0], [1.0]]
    assert schedule.done == 1.0


def test_slower_steps_are_foreseen_late_by_one_step_at_most(clock: Clock) -> None:
    schedule = Schedule(PHASES, 10.0)
    run(schedule, clock, (0.1, 0.4, 0.4))
    assert schedule.elapsed <= 10.0 + 2 * 0.4


def test_expected_steps_end_at_the_true_number(clock: Clock) -> None:
    schedule = Schedule(PHASES, 10.0)
    expected = []
    for index in range(3):
        for _ in schedule.within(index):
            clock.now += 0.3
            expected.append((schedule.begun, schedule.steps))
    assert expected[0] == (1, 20)
    assert all(steps >= begun for begun, steps in expected)
    assert all(abs(steps - schedule.begun) <= 2 for begun, steps in expected if begun > 20)
    assert expected[-1] == (schedule.begun, schedule.begun)


def test_an_end_in_between_leaves_what_lies_behind(clock: Clock) -> None:
    schedule = Schedule(PHASES, None)
    steps = schedule.within(0)
    next(steps)
    next(steps)
    assert schedule.done == pytest.approx(1 / 20)
    assert schedule.begun == 2


@given(st.lists(st.integers(1, 9), min_size=1, max_size=4), st.integers(0, 12))
def test_what_happens_evenly_is_due_once_each_unless_steps_are_too_few(counts: list[int], times: int) -> None:
    schedule = Schedule(tuple(Phase(count) for count in counts), None)
    for index, count in enumerate(counts):
        left = evenly(times)
        due = [fraction for fraction in schedule.within(index) if passed(left, fraction)]
        assert due == sorted({math.ceil((i + 1) / (times + 1) * count - 1e-9) / count for i in range(times)})
        assert left == []


def test_parts_are_even() -> None:
    assert evenly(3) == [0.25, 0.5, 0.75]
    left = evenly(3)
    assert not passed(left, 0.2)
    assert left == [0.25, 0.5, 0.75]
    assert passed(left, 0.5)
    assert left == [0.75]
