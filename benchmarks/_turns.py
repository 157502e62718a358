"""Measurements that take turns, so that a busy machine slows all of them alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import TypeVar

import click

__all__ = ["against", "in_turn", "median_seconds"]

Found = TypeVar("Found")

against = click.option(
    "--against",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="The python of an environment with another version of the package.",
)


def in_turn(pythons: Sequence[Path], repeat: int, run: Callable[[Path], Found]) -> list[list[Found]]:
    """What each of them found, run after run; who comes first changes, too."""
    found: dict[Path, list[Found]] = {python: [] for python in pythons}
    for number in range(repeat):
        for python in pythons if number % 2 else reversed(pythons):
            found[python].append(run(python))
    return [found[python] for python in pythons]


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
