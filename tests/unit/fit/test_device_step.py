"""A step on a GPU against the native step, the kernels compiled for the host (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

import numpy as np
import pytest
from fake_cuda import fake_gpu
from random_fit import random_fit

from sgicodec.device import ONE_THREAD
from sgicodec.fit.adam import Adam
from sgicodec.fit.device_fit import DeviceFit
from sgicodec.fit.fused_step import FusedStep
from sgicodec.fit.parameters import StepResult
from sgicodec.fit.pyramid import Level
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.fit_settings import Rounding
from sgicodec.raster.cpu import NativeRasterizer

WIDTH, HEIGHT, QUALITY, LMBDA, SEED = 80, 60, 62, 0.004, 12345
TOLERANCE = 5e-4
"""Of gradients, relative to their norm: two float32 programs, with Gaussians of axes up to e^(2 · 1.25) apart."""
RATES = {"colour": 0.028, "shape": 0.085, "offset": 0.085, "steps": 0.03}


class Pair:
    """The same fit twice, one on each device."""

    def __init__(self, spec: ModelSpec) -> None:
        self.layout, self.target, self.cpu, networks = random_fit(spec, WIDTH, HEIGHT, QUALITY, 1.25)
        self.gpu = random_fit(spec, WIDTH, HEIGHT, QUALITY, 1.25)[2]
        raster = NativeRasterizer(ONE_THREAD, cutoff=6.0)  # where what one draws and the other not is below rounding
        self.step = FusedStep(spec, SEED, networks, raster, ONE_THREAD)
        self.adams = Adam((0.9, 0.99), 1e-15), Adam((0.9, 0.99), 1e-15)
        self.fit = DeviceFit(spec, SEED, networks, fake_gpu(), self.gpu, self.adams[1], raster.cutoff)
        for one in (self.step, self.fit):
            one.set_layout(self.layout, QUALITY)
        self.levels: dict[int, Level] = {}

    def level(self, number: int, weighted: bool = False) -> Level:
        if number not in self.levels:
            samples = np.ascontiguousarray(self.target[:, :: 2**number, :: 2**number])
            weights = np.random.default_rng(9).uniform(0.2, 3.0, samples.shape[1:]).astype(np.float32)
            self.levels[number] = Level(samples, 0.5**number, weights if weighted else None)
        return self.levels[number]

    def run(
        self, rounding: Rounding, number: int = 0, level: int = 0, weighted: bool = False, rate: float = 0.0
    ) -> None:
        """A step of both, and that they say the same; their arrays move by `rate` times what a fit takes."""
        lmbda, at = (0.0 if rounding == "none" else LMBDA), self.level(level, weighted)
        expected = self.step.run(self.cpu, rounding, number, at, lmbda)
        rates = {name: rate * RATES[name] for name in self.cpu.trained()}
        error, bits = self.fit.run(rounding, number, at, lmbda, rates)
        assert (error, bits) == pytest.approx((expected.error, expected.bits), rel=2e-5)
        self.compare_gradients(expected)
        for name, array in self.cpu.trained().items():
            if name in expected.gradients:
                self.adams[0].move(name, array, expected.gradients[name], rates[name])

    def compare_gradients(self, expected: StepResult) -> None:
        for name, want in expected.gradients.items():
            found = self.fit._held._held[f"grad_{name}"].download()
            assert np.linalg.norm(want) > 0, name
            assert float(np.linalg.norm(found - want) / np.linalg.norm(want)) < TOLERANCE, name


SPECS = {
    "default": default_spec(3),
    "gray": default_spec(1),
    "four channels": default_spec(4),
}


@pytest.mark.parametrize("rounding", ["none", "noise"])
@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
def test_it_is_the_native_step(spec: ModelSpec, rounding: Rounding) -> None:
    Pair(spec).run(rounding)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("level", [0, 1])
def test_levels_and_weights(level: int, weighted: bool) -> None:
    Pair(SPECS["default"]).run("noise", level=level, weighted=weighted)


def test_many_steps_with_what_they_take_over() -> None:
    """Through a whole cycle of inputs and predictions that stand, with all arrays moving a little."""
    pair = Pair(SPECS["default"])
    for number in range(10):
        pair.run("noise", number, rate=0.01)
    pair.fit.fetch()
    for name, want in pair.cpu.trained().items():
        assert float(np.linalg.norm(pair.gpu.trained()[name] - want) / np.linalg.norm(want)) < 1e-4, name


def test_rounded_values() -> None:
    """Decisions at the end of an interval may fall to either side: a few of thousands."""
    pair = Pair(SPECS["default"])
    level = pair.level(0)
    expected = pair.step.run(pair.cpu, "round", 0, level, LMBDA)
    found = pair.fit.run("round", 0, level, LMBDA, dict.fromkeys(pair.cpu.trained(), 0.0))
    assert found == pytest.approx((expected.error, expected.bits), rel=1e-3)
