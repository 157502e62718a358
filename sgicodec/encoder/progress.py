"""The stages of an encode and how far it has come, from the first to the last."""

from __future__ import annotations

import time
from collections.abc import Mapping

from sgicodec.encoder.plan import Plan

__all__ = ["StageClock", "stage_weights"]

_PREPARE, _FIT, _SEARCH, _TEXTURE, _ASCENT, _ROUND, _VERIFY = 0.5, 5e-3, 1e-3, 0.4, 0.2, 0.6, 0.1
"""Seconds of each stage, of the fit and the search for each step, of texture for each pass of ascent or round of
requantisation besides, relative to the others: of a photograph of 0.4 megapixels. Machines and pictures differ in the
sum far more than in the shares.
"""

_MAX_ESTIMATED = 0.97
"""How much of a stage that does not say how far it is counts as done, however long it takes."""


def stage_weights(plan: Plan) -> dict[str, float]:
    """What share of the time each stage takes, relative to the others, in their order."""
    settings = plan.settings
    if plan.header.tile:
        again = {"more passes": 0.7} if settings.target else {}
        return {"load": 0.02, "tiles": 1.0, **again, "verify": 0.1}
    effort = settings.chosen_effort
    search = {"search": 0.45 + _SEARCH * effort.steps} if settings.rdoq and plan.header.spec.context.prior else {}
    seconds = _TEXTURE + _ASCENT * effort.ascent_passes + _ROUND * effort.rounds
    texture = {"texture": seconds} if plan.header.spec.texture else {}
    return {
        "load": 0.05,
        "prepare": _PREPARE,
        "fit": 0.1 + _FIT * effort.steps,
        **search,
        **texture,
        "verify": _VERIFY,
    }


class StageClock:
    """Which share of an encode is done, from 0 to 1, never less than before.

    A stage that says how far it is counts by that, another one by its time, at the pace of those before. One that
    begins again, as towards a target, shares with those behind it what is left.
    """

    def __init__(self) -> None:
        self.name = "load"
        self._weights: Mapping[str, float] = {"load": 1.0}
        self._first, self._base, self._done = "load", 0.0, 0.0
        self._share: float | None = None
        self._started = self._entered = self._restarted = time.monotonic()

    def plan(self, weights: Mapping[str, float]) -> None:
        """States the stages in their order."""
        self._weights = weights

    def begin(self, name: str) -> None:
        """A stage begins; one that is not planned belongs to the one before."""
        names = list(self._weights)
        if name not in names:
            return
        if self.name in names and names.index(name) <= names.index(self.name) and name != "load":
            self._base, self._first = self.fraction, name
            self._restarted = time.monotonic()
        self.name, self._share, self._entered = name, None, time.monotonic()

    def advance(self, share: float) -> None:
        """The stage says which share of it is done."""
        self._share = share

    def finish(self) -> None:
        """All is done."""
        self._done = 1.0

    @property
    def fraction(self) -> float:
        """Which share of the whole is done."""
        before, own, behind = self._sums()
        inner = self._share if self._share is not None else self._estimated(before, own)
        found = self._base + (1 - self._base) * (before + own * inner) / (before + own + behind)
        self._done = max(self._done, min(found, 1.0))
        return self._done

    @property
    def seconds_left(self) -> float | None:
        """Until all is done, at the pace so far; None before that can be said."""
        done = self.fraction
        return None if done < 0.03 else (time.monotonic() - self._started) * (1 - done) / done

    def _sums(self) -> tuple[float, float, float]:
        """The weights before the stage, since the last one that began again, its own and of those behind it."""
        names = list(self._weights)
        first, here = (names.index(name) if name in names else 0 for name in (self._first, self.name))
        weights = list(self._weights.values())
        return sum(weights[first:here]), weights[here], sum(weights[here + 1 :])

    def _estimated(self, before: float, own: float) -> float:
        spent = self._entered - self._restarted
        pace = spent / before if before > 0 and spent > 0 else 1.0
        return min(_MAX_ESTIMATED, (time.monotonic() - self._entered) / (pace * own))
