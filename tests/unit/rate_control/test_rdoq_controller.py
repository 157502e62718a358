"""RDOQ towards a target: λ between passes that are made up, the target of the fit before, estimates of streams."""

from __future__ import annotations

import math

import pytest

from sgicodec.rate_control.rdoq_controller import RdoqController, StreamEstimate, fit_target
from sgicodec.rate_control.target import Measured, RateTarget


def test_a_fit_may_end_larger_or_worse_than_the_target() -> None:
    assert fit_target(RateTarget(bytes=943)) == RateTarget(bytes=pytest.approx(1000))
    assert fit_target(RateTarget(psnr=30)) == RateTarget(psnr=pytest.approx(29.775))


def test_the_first_pass_moves_nothing() -> None:
    controller = RdoqController(RateTarget(bytes=1000), 0.01)
    controller.update(Measured(4000, 0.0))
    assert controller.lmbda == 0.01
    controller.update(Measured(4000, 0.0))
    assert controller.lmbda == 0.02


@pytest.mark.parametrize(("bytes_at_start", "elasticity"), [(1300.0, 0.2), (1300.0, 0.6), (1010.0, 0.4)])
def test_reaches_a_size_where_bytes_follow_lmbda_weakly(bytes_at_start: float, elasticity: float) -> None:
    target, made = RateTarget(bytes=1000), Measured(bytes_at_start, 0.0)
    controller = RdoqController(target, 0.01)
    controller.update(made)
    for _ in range(9):
        if target.is_met(made):
            break
        controller.update(made)
        made = Measured(bytes_at_start * (controller.lmbda / 0.01) ** -elasticity, 0.0)
    assert target.is_met(made)


def test_a_rise_grows_while_it_does_not_suffice_and_starts_anew_after_a_fall() -> None:
    controller = RdoqController(RateTarget(psnr=30), 1.0)
    moves = []
    for psnr in (30.0, 30.3, 30.3, 29.7, 30.3):
        before = controller.lmbda
        controller.update(Measured(1, psnr))
        moves.append(math.log2(controller.lmbda / before))
    assert moves == pytest.approx([0.0, 0.2, 0.3, -0.5, 0.2])


def test_estimates_learn_from_a_stream() -> None:
    estimate = StreamEstimate()

    def found(bits: float, psnr: float) -> tuple[float, float]:
        measured = estimate.of(bits, psnr)
        return measured.bytes, measured.psnr

    assert found(8000, 30.0) == (1000, 30.0)
    estimate.correct(8000, 30.0, Measured(1100, 29.5))
    assert found(16_000, 33.0) == (2100, 32.5)
    estimate.correct(8000, 30.0, Measured(1000, math.inf))
    assert found(8000, 30.0) == (1000, 29.5)
