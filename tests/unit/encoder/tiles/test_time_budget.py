"""What tiles are told of a time limit, by a clock that the test turns."""

from __future__ import annotations

import heapq
from collections.abc import Callable

import pytest
from clock import Clock
from examples import examples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sgicodec.encoder.tiles.tasks import EncodedTile
from sgicodec.encoder.tiles.time_budget import TimeBudget
from sgicodec.model.tile_grid import TileGrid

START = 1000.0


def tile(seeds: int = 9, decoding: float = 0.0) -> EncodedTile:
    return EncodedTile(b"", {}, seeds, 0.0, 0.0, 1, 1.0, 0, 0.01, decoding)


def row(count: int) -> TileGrid:
    """Equal tiles side by side, so small that writing the stream takes 0.5 s."""
    return TileGrid(64 * count, 64, 64, 0)


WRITING = 0.5


def worked(
    clock: Clock,
    budget: TimeBudget,
    count: int,
    workers: int,
    takes: Callable[[int, float], float],
    made: Callable[[int], EncodedTile] = lambda _: tile(),
) -> list[float]:
    """What each of `count` tiles is told, where it takes takes(number, told) seconds; the clock then shows the end."""
    budget.expect(range(count))
    told: list[float] = []
    busy: list[tuple[float, int]] = []
    while len(told) < count or busy:
        if len(told) < count and len(busy) < workers:
            number = len(told)
            told.append(budget.begin(number))
            heapq.heappush(busy, (clock.now + takes(number, told[-1]), number))
            continue
        clock.now, number = heapq.heappop(busy)
        budget.done(number, made(number))
    return told


@pytest.mark.parametrize(("count", "workers"), [(1, 1), (6, 1), (4, 4), (8, 2), (16, 4)])
def test_equal_tiles_have_equal_times(clock: Clock, count: int, workers: int) -> None:
    budget = TimeBudget(row(count), START + 100 + WRITING, workers, decoders=0)
    told = worked(clock, budget, count, workers, lambda _, told: told)
    assert told == pytest.approx([100 * workers / count] * count, rel=1e-3)
    assert clock.now == pytest.approx(START + 100, rel=1e-3)


def test_larger_tiles_have_more(clock: Clock) -> None:
    """Tiles at the ends have one apron, those between have two."""
    budget = TimeBudget(TileGrid(256, 64, 64, 16), START + 100 + WRITING, 1, decoders=0)
    told = worked(clock, budget, 4, 1, lambda _, told: told)
    assert told == pytest.approx([100 * width / 352 for width in (80, 96, 96, 80)], rel=1e-3)


def test_what_weighs_more_has_more(clock: Clock) -> None:
    """Two of no weight to speak of, as blank tiles, leave all to the others."""
    budget = TimeBudget(row(4), START + 60 + WRITING, 1, decoders=0, weigh=[1.0, 1e6, 2e6, 1.0].__getitem__)
    told = worked(clock, budget, 4, 1, lambda _, told: told)
    assert told[1:3] == pytest.approx([20, 40], rel=1e-3)


def test_start_up_is_part_of_the_limit(clock: Clock) -> None:
    budget = TimeBudget(row(4), START + 10 + WRITING, 2, decoders=0)
    clock.now += 4.0
    assert worked(clock, budget, 4, 2, lambda _, told: told) == pytest.approx([3.0] * 4, rel=1e-3)


def test_a_slow_tile_is_paid_for_by_all_that_follow(clock: Clock) -> None:
    """Its worker comes back late; none of the others is left without time."""
    budget = TimeBudget(row(16), START + 160 + WRITING, 2, decoders=0)
    told = worked(clock, budget, 16, 2, lambda number, told: 3 * told if number == 0 else told)
    assert told[:2] == pytest.approx([20, 20], rel=1e-3)
    assert min(told[2:]) > 10
    assert clock.now == pytest.approx(START + 160, abs=8)


def test_what_is_always_late_is_held_back(clock: Clock) -> None:
    """Each tile takes two seconds beyond what it is told: only the first ones do not know."""
    budget = TimeBudget(row(16), START + 160 + WRITING, 2, decoders=0)
    told = worked(clock, budget, 16, 2, lambda _, told: told + 2)
    assert told[:2] == pytest.approx([20, 20], rel=1e-3)
    assert told[4:] == pytest.approx([17.7] * 12, abs=0.6)
    assert clock.now == pytest.approx(START + 160, abs=0.5)


def test_what_is_always_early_is_given_more(clock: Clock) -> None:
    """But none more than is left."""
    budget = TimeBudget(row(16), START + 160 + WRITING, 2, decoders=0)
    told = worked(clock, budget, 16, 2, lambda _, told: told - 2)
    assert told[4:-2] == pytest.approx([22.2] * 10, abs=0.3)
    assert START + 157 < clock.now <= START + 160


def test_blank_tiles_hand_their_time_on(clock: Clock) -> None:
    """The first half takes nothing: the other half has all the time, and nothing is learned from blank ones."""
    budget = TimeBudget(row(8), START + 80 + WRITING, 1, decoders=0)
    told = worked(clock, budget, 8, 1, lambda n, told: 0.0 if n < 4 else told, lambda n: tile(seeds=0 if n < 4 else 9))
    assert told[4:] == pytest.approx([20] * 4, rel=1e-3)


def test_the_last_turn_keeps_a_part(clock: Clock) -> None:
    """17 tiles by 16 workers: what comes last would get a seventeenth of the time that the others have."""
    budget = TimeBudget(row(17), START + 100 + WRITING, 16, decoders=0)
    told = worked(clock, budget, 17, 16, lambda _, told: told)
    assert min(told) == told[-1] == pytest.approx(25, rel=0.01)
    assert clock.now <= START + 100.01


def test_decoding_is_kept_back_as_it_was_measured(clock: Clock) -> None:
    """Each of 10 tiles took 2 s to decode: 20 s by one thread, half of it by two, no less by four."""
    for decoders, least in ((1, 20.0), (2, 10.0), (4, 10.0), (0, 0.0)):
        clock.now = START
        budget = TimeBudget(row(10), START + 100, 1, decoders)
        worked(clock, budget, 10, 1, lambda _, told: told, lambda _: tile(decoding=2.0))
        assert clock.now == pytest.approx(START + 100 - least - WRITING, abs=0.02)


def test_too_little_time_is_told_as_next_to_nothing(clock: Clock) -> None:
    budget = TimeBudget(row(4), START + 1, 2, decoders=0)
    told = worked(clock, budget, 4, 2, lambda _, told: told + 5)
    assert all(seconds > 0 for seconds in told)
    assert told[-1] < 0.01


def test_a_second_try_has_what_is_left(clock: Clock) -> None:
    budget = TimeBudget(row(4), START + 80 + WRITING, 1, decoders=0)
    budget.expect(range(4))
    assert budget.begin(0) == pytest.approx(20, rel=1e-3)
    clock.now += 20
    assert budget.begin(0) == pytest.approx(15, rel=1e-3)


@pytest.mark.parametrize("count", [1, 7])
def test_only_what_is_expected_counts(clock: Clock, count: int) -> None:
    """After an interruption the other tiles are there already."""
    budget = TimeBudget(row(9), START + 70 + WRITING, 1, decoders=0)
    budget.expect(range(2, 2 + count))
    assert budget.begin(2) == pytest.approx(70 / count, rel=1e-3)


@settings(max_examples=examples(200), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(1, 40), st.integers(1, 9), st.randoms(use_true_random=False))
def test_the_limit_holds_where_no_tile_takes_longer(clock: Clock, count: int, workers: int, random: object) -> None:
    clock.now = START
    budget = TimeBudget(row(count), START + 100, workers, decoders=0)
    part = random.uniform  # type: ignore[attr-defined]
    told = worked(clock, budget, count, workers, lambda _, told: told * part(0.9, 1.0))
    assert min(told) > 0
    assert clock.now <= START + 100
    assert clock.now >= START + 75
