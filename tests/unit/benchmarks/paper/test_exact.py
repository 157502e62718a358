"""Fits without quantisation: the published phases, with exact values."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.paper.exact import exact_fit, without_quantisation
from benchmarks.paper.jobs import PaperFit
from sgicodec.bench.run import load_sample

KODIM = Path(__file__).parents[3] / "data" / "kodim23.png"


def test_phases_keep_their_steps_and_lose_their_noise() -> None:
    published = PaperFit(100, 15_000).settings().fit_settings()
    exact = without_quantisation(published)
    assert [(phase.steps, phase.level) for phase in exact.phases] == [
        (phase.steps, phase.level) for phase in published.phases
    ]
    assert {(phase.rounding, phase.rate, phase.learn_steps) for phase in exact.phases} == {("none", False, False)}
    assert exact.lmbda == 0
    assert (exact.rates, exact.loss, exact.seed) == (published.rates, published.loss, published.seed)


def test_more_steps_come_nearer() -> None:
    pixels = np.ascontiguousarray(load_sample(KODIM).pixels[200:248, 100:164])
    short, longer = (exact_fit(pixels, PaperFit(40, steps), 1) for steps in (10, 120))
    assert longer.psnr > short.psnr + 3
    assert min(short.seconds, short.cpu_seconds) > 0
