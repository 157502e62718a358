"""Fits without quantisation: the published phases, with exact values."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.paper.exact import exact_fit
from benchmarks.paper.jobs import PaperFit
from sgicodec.bench.run import load_sample

KODIM = Path(__file__).parents[3] / "data" / "kodim23.png"


def test_no_phase_has_noise() -> None:
    phases = PaperFit(100, 15_000, lmbda=0.0).settings().fit_settings().phases
    assert [(phase.steps, phase.level) for phase in phases] == [(3000, 2), (6000, 1), (6000, 0)]
    assert {(phase.rounding, phase.rate, phase.learn_steps) for phase in phases} == {("none", False, False)}


def test_more_steps_come_nearer() -> None:
    pixels = np.ascontiguousarray(load_sample(KODIM).pixels[200:248, 100:164])
    short, longer = (exact_fit(pixels, PaperFit(40, steps), 1) for steps in (10, 120))
    assert longer.psnr > short.psnr + 3
    assert min(short.seconds, short.cpu_seconds) > 0
