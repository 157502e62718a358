"""Measurements that take turns, so that a busy machine slows all of them alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Sequence
from pathlib import Path
from statistics import median
from typing import TypeVar

import click

Key = TypeVar("Key", bound=Hashable)
Found = TypeVar("Found")

against = click.option(
    "--against",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="The python of an environment with another version of the package.",
)


def in_turn(those: Sequence[Key], repeat: int, run: Callable[[Key], Found]) -> list[list[Found]]:
    """What each of them found, run after run; who comes first changes, too."""
    found: dict[Key, list[Found]] = {each: [] for each in those}
    for number in range(repeat):
        for each in those if number % 2 else reversed(those):
            found[each].append(run(each))
    return [found[each] for each in those]


def median_seconds(
    calls: Sequence[Callable[[], object]], repeat: int, clock: Callable[[], float] = time.perf_counter
) -> list[float]:
    """Median of each call by this clock, after a turn that finds memory."""
    seconds: list[list[float]] = [[] for _ in calls]
    for turn in range(repeat + 1):
        for call, times in zip(calls, seconds, strict=True):
            start = clock()
            call()
            if turn:
                times.append(clock() - start)
    return [median(times) for times in seconds]
