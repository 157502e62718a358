"""From a picture to a stream of a given size or PSNR, in about the time of any other stream."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.tile_encoder import Candidate, Encoding
from sgicodec.errors import TargetMissedError
from sgicodec.fit.base_layer import base_layer
from sgicodec.metrics.distortion import decibels
from sgicodec.model.context import input_count
from sgicodec.rate_control.convergence import searched
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.rd_model import initial_lmbda
from sgicodec.rate_control.step_search import coarser, trim
from sgicodec.rate_control.target import Measured, RateTarget
from sgicodec.rdoq import Cost

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Fitted, Progress

__all__ = ["TargetEncoder"]

Reached = tuple[Encoded, Measured]


class TargetEncoder:
    """Takes an encoding to a goal.

    λ moves while the fit runs, on what its state foretells; then from pass to pass of RDOQ, on the stream that each
    would give. What is still too large or too bad has all its steps trimmed.
    """

    def __init__(self, encoding: Encoding, goal: RateTarget) -> None:
        self.encoding, self.goal = encoding, goal

    def run(self, on_progress: Callable[[Progress], bool] | None) -> Encoded:
        """Fits and writes. Raises TargetMissedError, with the nearest stream, where the goal cannot be reached."""
        encoding, goal, ended = self.encoding, self.goal, False
        if encoding.holds_nothing:
            return encoding.nothing()

        def watch(state: Progress) -> bool:
            nonlocal ended
            ended = on_progress is not None and not on_progress(state)
            return not ended

        encoding.begin(self._first_lmbda())
        encoded, measured = self._reached(self._fitted(watch))
        little = goal.psnr is not None and goal.rate_error(measured) > -_LITTLE
        if goal.is_missed(measured) and little and not ended and encoding.settings.time_limit is None:
            # Seeds were dropped that were needed: once more, from where λ should have begun, and below.
            encoding.begin(0.5 * math.sqrt(encoding.fit.lmbda * encoded.lmbda))
            again = self._reached(self._fitted(watch, leaps=False))
            encoded, measured = max((encoded, measured), again, key=lambda one: one[1].psnr)
        if goal.is_missed(measured):
            raise TargetMissedError(goal.miss_message(measured), encoded)
        return encoded

    def _first_lmbda(self) -> float:
        encoding = self.encoding
        _, _, detail = base_layer(encoding.spec, encoding.unit, encoding.fit.lmbda)
        lmbda = encoding.fit.lmbda
        if self.goal.bytes is None:
            return initial_lmbda(self.goal, detail, encoding.fit.split_price, self._extra())
        for _ in range(3):  # what the search will leave of the bytes depends on λ, a little
            lmbda = initial_lmbda(self._fit_goal(lmbda), detail, encoding.fit.split_price, self._extra())
        return lmbda

    def _fit_goal(self, lmbda: float) -> RateTarget:
        """Where a fit at about λ has to end so that RDOQ ends at the goal."""
        if not self.encoding.searches:
            return self.goal
        share, decibels = searched(self.encoding.fit.steps, lmbda)
        if self.goal.bytes is not None:
            return RateTarget(bytes=self.goal.bytes / share)
        return RateTarget(psnr=(self.goal.psnr or 0.0) - _SURE * decibels)

    def _fitted(self, on_progress: Callable[[Progress], bool], leaps: bool = True) -> Fitted:
        encoding = self.encoding
        lmbda = encoding.fit.lmbda
        numbers = encoding.target.size / max(1, encoding.spec.base_cell**2)
        overhead = _OVERHEAD + _BASE_BYTES * numbers + self._extra()
        controller = LambdaController(self._fit_goal(lmbda), lmbda, overhead, leaps)
        return encoding.fitted(on_progress, controller, share=2.0)

    def _extra(self) -> float:
        """Bytes that most streams do not have: metadata and networks of their own."""
        spec = self.encoding.spec
        inputs = sum(input_count(spec, step) for step in range(len(spec.context.steps)))
        weights = 0 if spec.context.prior else spec.context.hidden * inputs
        return self.encoding.blob_bytes() + _WEIGHT_BYTES * weights

    def _reached(self, fitted: Fitted) -> Reached:
        encoding, goal, candidate = self.encoding, self.goal, self.encoding.candidate(fitted)
        if encoding.searches:
            candidate, found = self._searched(candidate)
            if goal.is_met(found[1]):
                return found
        tried: dict[int, Reached] = {}

        def measure(shift: int) -> Measured:
            tried[shift] = encoding.measured(_shifted(candidate, shift))
            return tried[shift][1]

        return tried[trim(goal, measure)]

    def _searched(self, start: Candidate) -> tuple[Candidate, Reached]:
        """Passes until the goal is met, but as often as without one; the last that met it, else the nearest."""
        encoding, goal, rdoq = self.encoding, self.goal, self.encoding.rdoq(start)
        gauge = _Gauge(encoding.unit.size)
        tries: list[tuple[Candidate, Measured]] = []
        lmbda, least, up = start.lmbda, rdoq.settings.passes, _UP
        for number in range(least + _MORE_PASSES):
            began = time.monotonic()
            refined = rdoq.descend(lmbda)
            candidate, measured = Candidate(start.header, refined.model, lmbda), gauge.told(refined.cost)
            if number == 0 or (number >= least - 1 and goal.is_met(measured)):
                found = encoding.measured(candidate)
                measured = gauge.learn(refined.cost, found[1])
                if number >= least - 1 and goal.is_met(measured):
                    return candidate, found
            tries.append((candidate, measured))
            if 2 * time.monotonic() - began > encoding.end:
                break
            if number >= _UNSETTLED:
                excess = goal.rate_error(measured)
                lmbda *= 2.0 ** max(-_MOST_MOVE, min(_MOST_MOVE, (_DOWN if excess < 0 else up) * excess))
                up = _UP if excess < 0 else _MORE_UP * up
        met = [one for one in tries if goal.is_met(one[1])]
        sound = [one for one in tries if not goal.is_missed(one[1])]
        candidate, _ = met[-1] if met else min(sound or tries, key=lambda one: abs(goal.rate_error(one[1])))
        return candidate, encoding.measured(candidate)


class _Gauge:
    """What streams would be, from what a search knows of them, by how far that was off where a stream was measured."""

    def __init__(self, samples: int) -> None:
        self._samples, self._bytes, self._decibels = samples, 0.0, 0.0

    def told(self, cost: Cost) -> Measured:
        """The search counts neither the container nor the rounding of samples."""
        return Measured(cost.bits / 8 + self._bytes, decibels(cost.squared_error, self._samples) + self._decibels)

    def learn(self, cost: Cost, measured: Measured) -> Measured:
        """Takes in what the stream of this cost is, and returns it."""
        self._bytes = measured.bytes - cost.bits / 8
        if math.isfinite(measured.psnr):
            self._decibels = measured.psnr - decibels(cost.squared_error, self._samples)
        return measured


_SURE = 0.5
"""Of what searches usually add to PSNR, what a fit counts on: they drop seeds that are too many, but add none."""
_UNSETTLED = 1
"""Passes whose outcome says little: scales are not fitted yet, and seeds that do not pay are still there."""
_UP, _MORE_UP, _DOWN, _MOST_MOVE = 1.0, 1.5, 2.5, 1.0
"""By what multiple of what λ is off it moves between two passes: up, and how much further each time that it must rise
again; down; and the most octaves. Seeds can be dropped but not added, so that a smaller λ does less than a larger one.
"""
_MORE_PASSES = 5
"""Passes beyond the usual."""
_OVERHEAD, _BASE_BYTES, _WEIGHT_BYTES = 250.0, 0.4, 1.2
"""About what a stream holds beside its seeds: header, steps and differences; for each number of the base layer; for
each weight of an own network.
"""
_LITTLE = 1.0
"""Octaves of λ by which a PSNR may be missed for a second fit."""


def _shifted(candidate: Candidate, shift: int) -> Candidate:
    """The candidate with all steps of its attributes coarser by `shift` units."""
    model = candidate.model
    return replace(candidate, model=replace(model, networks=coarser(model.networks, shift), decoded=None))
