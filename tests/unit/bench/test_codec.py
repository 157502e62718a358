"""Timing: short calls are repeated and the best counts, long ones run once."""

from __future__ import annotations

import pytest

from sgicodec.bench import codec


class Clock:
    """A clock that the timed calls move on."""

    def __init__(self) -> None:
        self.now = 0.0
        self.calls = 0

    def perf_counter(self) -> float:
        return self.now

    def spend(self, *seconds: float) -> int:
        self.now += seconds[self.calls]
        self.calls += 1
        return self.calls


@pytest.mark.parametrize(
    ("seconds", "calls", "best"), [((0.03, 0.01, 0.02), 3, 0.01), ((0.4, 0.2), 1, 0.4), ((0.2, 9), 1, 0.2)]
)
def test_best_of_three_short_calls_or_one_long_one(
    monkeypatch: pytest.MonkeyPatch, seconds: tuple[float, ...], calls: int, best: float
) -> None:
    clock = Clock()
    monkeypatch.setattr(codec, "time", clock)
    result, measured = codec.timed(lambda: clock.spend(*seconds))
    assert (result, clock.calls) == (calls, calls)
    assert measured == pytest.approx(best)
