"""A clock that tests turn instead of waiting."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Clock:
    """Stands in for time.monotonic; moves on by `tick` seconds whenever somebody looks at it."""

    now: float = 1000.0
    tick: float = 0.0

    def __call__(self) -> float:
        self.now += self.tick
        return self.now
