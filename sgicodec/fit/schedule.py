"""How far a fit has come, counted in steps, and what is due by then."""

from __future__ import annotations

from collections.abc import Iterator

from sgicodec.profiles.fit_settings import Phase

__all__ = ["Schedule", "evenly", "passed"]


class Schedule:
    """Counts the steps of a fit, phase by phase. steps: of the whole fit; done: the fraction of them that lies behind,
    without the step under way.
    """

    def __init__(self, phases: tuple[Phase, ...]) -> None:
        self.phases = phases
        self.steps = sum(phase.steps for phase in phases)
        self.done = 0.0

    def within(self, index: int) -> Iterator[float]:
        """One value for each step of a phase: the fraction of the phase that this step completes."""
        before, count = sum(phase.steps for phase in self.phases[:index]), self.phases[index].steps
        for number in range(1, count + 1):
            yield number / count
            self.done = (before + number) / self.steps


def evenly(times: int) -> list[float]:
    """`times` fractions that part a phase evenly."""
    return [(i + 1) / (times + 1) for i in range(times)]


def passed(fractions: list[float], now: float) -> bool:
    """Whether the first of `fractions`, which rise, lies behind `now`; all that do are dropped."""
    has_passed = False
    while fractions and fractions[0] <= now:
        del fractions[0]
        has_passed = True
    return has_passed
