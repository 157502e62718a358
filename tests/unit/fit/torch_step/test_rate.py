"""Rates against the tables that code them."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import torch

from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.model.quantization import PER_OCTAVE, SCALE_ZERO
from tests.support.torch_step.rate import bits_gaussian, bits_laplace

Rate = Callable[[torch.Tensor, torch.Tensor, torch.Tensor], torch.Tensor]


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


@pytest.mark.parametrize(("step", "scale"), [(0.01, 0.05), (3.0, 2.5)])
def test_bits_between_symbols_are_those_of_the_distribution(step: float, scale: float) -> None:
    deviation, q, s = step * torch.linspace(-2.2, 1.7, 40).double(), *torch.tensor([step, scale]).double()
    for bits, density in (
        (bits_gaussian, torch.distributions.Normal(0.0, s)),
        (bits_laplace, torch.distributions.Laplace(0.0, s / 2**0.5)),
    ):
        mass = density.cdf(deviation + q / 2) - density.cdf(deviation - q / 2)
        np.testing.assert_allclose(bits(deviation, q, s), -torch.log2(mass), rtol=1e-6)
