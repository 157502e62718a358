"""Rates against distribution functions and finite differences in float64, and against the tables that code them."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import torch

from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.model.quantization import PER_OCTAVE, SCALE_ZERO
from tests.support.torch_step.rate import bits_gaussian, bits_laplace

Rate = Callable[[torch.Tensor, torch.Tensor, torch.Tensor], torch.Tensor]


def gaussian(x: float) -> float:
    return 0.5 * math.erfc(-x / math.sqrt(2))


def laplace(x: float) -> float:
    """Distribution function for a standard deviation of 1."""
    return 0.5 * math.exp(math.sqrt(2) * x) if x < 0 else 1 - 0.5 * math.exp(-math.sqrt(2) * x)


FAMILIES = [(bits_gaussian, gaussian), (bits_laplace, laplace)]
families = pytest.mark.parametrize(("bits", "distribution"), FAMILIES, ids=["gaussian", "laplace"])


def grid() -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Deviations on both sides of the step's edge, steps and scales over octaves; no symbol cheaper than 2^-20."""
    cases = [
        (fraction * step, step, scale)
        for step in (0.01, 1.0, 3.0)
        for scale in (0.2 * step, step, 9 * step)
        for fraction in (-2.2, -0.51, -0.5, -0.3, 0.0, 0.2, 0.49, 0.5, 1.0, 1.7)
    ]
    deviation, step, scale = torch.tensor(cases, dtype=torch.float64).T
    return deviation.clone(), step.clone(), scale.clone()


@families
def test_bits_are_those_of_the_mass(bits: Rate, distribution: Callable[[float], float]) -> None:
    arguments = grid()
    found = bits(*arguments)
    for d, q, s, value in zip(*(a.tolist() for a in arguments), found.tolist(), strict=True):
        mass = distribution(-(abs(d) - q / 2) / s) - distribution(-(abs(d) + q / 2) / s)
        assert value == pytest.approx(min(20.0, -math.log2(max(mass, 1e-300))), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("family", "bits"), [(0, bits_gaussian), (1, bits_laplace)])
@pytest.mark.parametrize("scale", [12, SCALE_ZERO, 40])
def test_the_tables_cost_what_the_fit_believes(family: int, bits: Rate, scale: int) -> None:
    """Symbols that a scale index makes likely: the fit's bits with σ = 2^((index − 24) / 6) steps."""
    sigma = 2.0 ** ((scale - SCALE_ZERO) / PER_OCTAVE)
    symbols = np.arange(-math.ceil(3 * sigma), math.ceil(3 * sigma) + 1)
    coded = frequency_tables().bits(symbols, np.full(len(symbols), scale + SCALES * family))
    believed = bits(torch.tensor(symbols, dtype=torch.float64), torch.ones(1).double(), torch.tensor(sigma).double())
    likely = coded < 18
    np.testing.assert_allclose(believed.numpy()[likely], coded[likely], atol=0.02)
