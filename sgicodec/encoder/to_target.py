"""Encodes a picture as one tile to a rate target, a size or a PSNR, with one fit."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from sgicodec.encoder.candidate import Candidate
from sgicodec.encoder.target_encoder import Stream, TargetEncoder
from sgicodec.metrics.distortion import decibels
from sgicodec.model.network import DIFFERENCE_SHIFT
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.rd_model import initial_lmbda
from sgicodec.rate_control.rdoq_controller import MAX_EXTRA_PASSES, RdoqController, StreamEstimate, fit_target
from sgicodec.rate_control.side_information import side_bytes
from sgicodec.rate_control.step_search import step_shift
from sgicodec.rate_control.target import Measured, RateTarget
from sgicodec.rdoq.adaptation import with_coarser_steps

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Fitted, Progress

__all__ = ["SeedTargetEncoder"]

REFIT_MAX_ERROR = 1.0
"""Rate error, octaves of λ, up to which a missed PSNR is worth a second fit."""


class SeedTargetEncoder(TargetEncoder):
    """Takes an encoding to a rate target: λ moves during the fit, then between the passes of RDOQ; what still misses
    the target has all its steps shifted.
    """

    def _best(self, on_progress: Callable[[Progress], bool]) -> Stream:
        """One fit, or two towards a PSNR that the first missed by little."""
        encoding, target = self.encoding, self.target
        encoding.begin(self._initial_lmbda())
        encoded, measured = self._stream(self._fitted(on_progress))
        is_near = target.psnr is not None and target.rate_error(measured) > -REFIT_MAX_ERROR
        if target.is_missed(measured) and is_near and not self.ended and encoding.settings.time_limit is None:
            # Seeds were dropped that were needed: once more, from where λ should have begun, and below.
            encoding.begin(0.5 * math.sqrt(encoding.fit.lmbda * encoded.lmbda))
            again = self._stream(self._fitted(on_progress, jumps=False))
            encoded, measured = max((encoded, measured), again, key=lambda one: one[1].psnr)
        return encoded, measured

    def _initial_lmbda(self) -> float:
        target = self._fit_target if self.target.psnr is None else self.target
        return initial_lmbda(target, self.encoding.rd_model(), self._extra())

    @property
    def _fit_target(self) -> RateTarget:
        return fit_target(self.target) if self.encoding.searches else self.target

    def _fitted(self, on_progress: Callable[[Progress], bool], jumps: bool = True) -> Fitted:
        encoding = self.encoding
        overhead = side_bytes(encoding.target.size / max(1, encoding.spec.base_cell**2), self._extra())
        controller = LambdaController(self._fit_target, encoding.fit.lmbda, overhead, jumps)
        return encoding.fitted(on_progress, controller, share=2.0)

    def _stream(self, fitted: Fitted) -> Stream:
        encoding, target, candidate = self.encoding, self.target, self.encoding.candidate(fitted)
        if encoding.searches:
            candidate, found = self._optimised(candidate)
            if target.is_met(found[1]):
                return found
        tried: dict[float, Stream] = {}

        def measure(shift: float) -> Measured:
            tried[shift] = encoding.measured(_shifted(candidate, shift))
            return tried[shift][1]

        return tried[step_shift(target, measure)]

    def _optimised(self, start: Candidate) -> tuple[Candidate, Stream]:
        """RDOQ in at least as many passes as without a target; the last one that met it, else the nearest."""
        encoding, target, rdoq = self.encoding, self.target, self.encoding.rdoq(start)
        controller, estimate = RdoqController(target, start.lmbda), StreamEstimate()
        tries: list[tuple[Candidate, Measured]] = []
        for number in range(rdoq.settings.passes + MAX_EXTRA_PASSES):
            began, may_end = time.monotonic(), number >= rdoq.settings.passes - 1
            found = rdoq.descend(controller.lmbda)
            candidate = Candidate(start.header, found.model, controller.lmbda)
            bits, psnr = found.cost.bits, decibels(found.cost.squared_error, encoding.unit.size)
            measured = estimate.of(bits, psnr)
            if number == 0 or (may_end and target.is_met(measured)):
                encoded, measured = encoding.measured(candidate)
                estimate.correct(bits, psnr, measured)
                if may_end and target.is_met(measured):
                    return candidate, (encoded, measured)
            tries.append((candidate, measured))
            if encoding.ending() or 2 * time.monotonic() - began > encoding.time.end:
                break
            controller.update(measured)
        met = [candidate for candidate, measured in tries if target.is_met(measured)]
        candidate = met[-1] if met else tries[target.nearest([measured for _, measured in tries])][0]
        return candidate, encoding.measured(candidate)


def _shifted(candidate: Candidate, shift: float) -> Candidate:
    """The candidate with all steps of its attributes coarser by `shift` units."""
    model = candidate.model
    networks = with_coarser_steps(model.networks, shift / 2**DIFFERENCE_SHIFT)
    return replace(candidate, model=replace(model, networks=networks))
