"""How far a fit has come, counted in steps or, where only the time is given, by the clock; and what is due by then."""

from __future__ import annotations

import time
from collections.abc import Iterator

from sgicodec.profiles.fit_settings import Phase

__all__ = ["Schedule", "evenly", "passed"]


class Schedule:
    """Shares a fit's steps, or `seconds` from its first step on, out to its phases in the proportion of their steps.

    `done` is the fraction of the whole fit that lies behind, without the step under way; `steps` is how many steps the
    whole fit has: exact when they are counted, else what the speed so far lets expect.
    """

    def __init__(self, phases: tuple[Phase, ...], seconds: float | None) -> None:
        self.phases, self.seconds = phases, seconds
        self.total = sum(phase.steps for phase in phases)
        self.started: float | None = None
        self.begun = 0
        self.done = 0.0
        self._reached = 0.0

    @property
    def steps(self) -> int:
        """Steps of the whole fit."""
        if self.seconds is None or not self._reached:
            return self.total
        return max(self.begun, round(self.begun / self._reached))

    @property
    def elapsed(self) -> float:
        """Seconds since the first step began."""
        return 0.0 if self.started is None else time.monotonic() - self.started

    def within(self, index: int) -> Iterator[float]:
        """One value for each step of a phase: the fraction of the phase that this step completes. At least one step."""
        self.started = time.monotonic() if self.started is None else self.started
        before = sum(phase.steps for phase in self.phases[:index])
        count = self.phases[index].steps
        if self.seconds is None:
            for number in range(1, count + 1):
                self._begin((before + number) / self.total)
                yield number / count
                self.done = self._reached
            return
        begin, end = before / self.total, (before + count) / self.total
        fraction = 0.0
        while fraction < 1.0:
            # The step to come is taken to last as long as the mean step so far.
            elapsed = self.elapsed
            coming = elapsed / self.begun if self.begun else 0.0
            fraction = min(1.0, max(0.0, ((elapsed + coming) / self.seconds - begin) / (end - begin)))
            self._begin(begin + fraction * (end - begin))
            yield fraction
            self.done = self._reached

    def _begin(self, reached: float) -> None:
        self.begun += 1
        self._reached = reached


def evenly(times: int) -> list[float]:
    """`times` fractions that part a phase evenly."""
    return [(i + 1) / (times + 1) for i in range(times)]


def passed(fractions: list[float], now: float) -> bool:
    """Whether the first of `fractions`, which rise, lies behind `now`; all that do are dropped."""
    found = False
    while fractions and fractions[0] <= now:
        del fractions[0]
        found = True
    return found
