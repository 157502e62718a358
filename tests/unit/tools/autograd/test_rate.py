"""Rates against distribution functions and finite differences in float64, and against the tables that code them."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import torch

from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.model.quantization import PER_OCTAVE, SCALE_ZERO
from tools.autograd.rate import bits_gaussian, bits_laplace

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


@families
def test_gradients_against_central_differences(bits: Rate, distribution: Callable[[float], float]) -> None:
    arguments = [argument.requires_grad_() for argument in grid()]
    value = bits(*arguments)
    value.sum().backward()
    paid = value.detach() < 19.9  # the floor has no slope
    unit = arguments[1].detach()  # gradients per step
    for index, argument in enumerate(arguments):
        above, below = ([a.detach().clone() for a in arguments] for _ in range(2))
        above[index] += 1e-6 * unit
        below[index] -= 1e-6 * unit
        numeric = (bits(*above) - bits(*below)) / 2e-6
        assert argument.grad is not None
        np.testing.assert_allclose((argument.grad * unit)[paid].numpy(), numeric[paid].numpy(), rtol=1e-5, atol=1e-6)


@families
def test_the_floor_is_what_an_escape_costs(bits: Rate, distribution: Callable[[float], float]) -> None:
    deviation = torch.tensor([1000.0, -1000.0], requires_grad=True)
    value = bits(deviation, torch.ones(2), torch.ones(2))
    assert value.tolist() == [20.0, 20.0]
    value.sum().backward()
    assert deviation.grad is not None
    assert deviation.grad.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("bits", [bits_gaussian, bits_laplace])
def test_float32_stays_finite(bits: Rate) -> None:
    deviation = torch.tensor([0.0, 1e-20, 1e-3, 1.0, 1e4]).repeat(9).requires_grad_()
    step = torch.tensor([2.0**-16, 1.0, 2.0]).repeat_interleave(5).repeat(3).requires_grad_()
    scale = (step.detach() * torch.tensor([0.0625, 1.0, 4096.0]).repeat_interleave(15)).requires_grad_()
    value = bits(deviation, step, scale)
    value.sum().backward()
    for tensor in (value, deviation.grad, step.grad, scale.grad):
        assert tensor is not None
        assert torch.isfinite(tensor).all()
    assert torch.all((value >= 0) & (value <= 20))


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
