"""Biases of MLP_p: what they change, and that they change nothing else."""

import numpy as np
import pytest

from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.profiles.default import default_spec
from sgicodec.rdoq.adaptation import fitted_scales, with_coarser_steps
from sgicodec.rdoq.coordinate_descent import Symbols

SPEC = default_spec(3)


@pytest.mark.parametrize("octaves", [-1.0, 0.25, 2.0])
def test_coarser_steps_leave_means_and_scales(octaves: float) -> None:
    networks = load_prior(SPEC)
    for before, after in zip(networks, with_coarser_steps(networks, octaves), strict=True):
        for name in ("w1", "b1", "w2"):
            np.testing.assert_array_equal(getattr(after, name), getattr(before, name))
        more, others = (after.b2 - before.b2) * 2.0**-before.shift, 2 * before.predicted
        assert not more[:others].any()
        np.testing.assert_array_equal(more[others:], octaves)


def symbols_of(scale: np.ndarray, seed: int = 0) -> np.ndarray:
    """Laplacian symbols [n, size] as the tables of these scale indices expect them."""
    deviation = 2.0 ** ((scale - 24) / 6)
    return np.rint(np.random.default_rng(seed).laplace(0, deviation / np.sqrt(2), scale.shape)).astype(np.int32)


def test_scales_move_to_where_the_symbols_are() -> None:
    rng = np.random.default_rng(1)
    true = rng.integers(26, 40, (4000, 8))
    moved = np.array([3, 3, 3, -4, 0, 6, 0, -6])
    found = Symbols(symbols_of(true), (true - moved).astype(np.int16), np.zeros(4000), family=1)
    networks = load_prior(SPEC)
    fitted = fitted_scales(SPEC, networks, found)
    more = np.concatenate(
        [
            (new.b2 - old.b2)[old.predicted : 2 * old.predicted] / 2.0**old.shift
            for old, new in zip(networks, fitted, strict=True)
        ]
    )
    assert np.abs(6 * more - moved).max() <= 1.1
    bits = frequency_tables().bits
    assert bits(found.symbols, found.scale + moved + SCALES).sum() < bits(found.symbols, found.scale + SCALES).sum()
