"""Restoration is what docs/format.md says, for tiles of any size and any channels, on all instruction sets."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
from data_files import ROOT
from restoration_reader import PARTS, corrected
from scenes import ISAS

from sgicodec.device import Device
from sgicodec.model.restoration import Restoration

NETWORKS = sorted(int(path.stem.removeprefix("restoration")) for path in PARTS.glob("restoration*.bin"))
SHAPES = [(3, 70, 130), (3, 1, 1), (3, 2, 200), (3, 200, 3), (1, 40, 50), (2, 40, 50), (4, 67, 125), (5, 64, 120)]


def tile(shape: tuple[int, int, int], step: int, seed: int = 0) -> np.ndarray:
    """Edges and noise, at places where no input of the network lies near the middle of two integers."""
    rng, (_, rows, columns) = np.random.default_rng(seed), shape
    x, y = np.arange(columns) / 9, np.arange(rows)[:, None] / 7
    waves = np.sign(np.sin(x + y)) * 0.3 + 0.5 + rng.normal(size=shape) * 0.05
    waves[:, :1, :1] = 40.0  # far beyond white
    delta = 2.0 ** ((step - 480) / 32)
    return np.asarray((np.rint(128 * waves / delta) + rng.uniform(-0.2, 0.2, shape)) * delta / 128, np.float32)


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("step", [511, 360, 290])
def test_it_is_what_the_page_says(network: int, shape: tuple[int, int, int], step: int) -> None:
    drawn = tile(shape, step)
    found, expected = Restoration(network, step).correction(drawn), corrected(drawn.astype(np.float64), network, step)
    assert found.shape == shape
    assert np.abs(expected).max() > 0
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=2e-6)


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize("size", [0.01, 1.0, 8.0, 20.0, 60.0, 200.0, 1000.0])
def test_values_may_have_any_size(network: int, size: float) -> None:
    """Layers with small inputs are computed in squares of four outputs, others are not: sums are the same."""
    rng = np.random.default_rng(7)
    drawn = np.float32(rng.uniform(-1, 1, (1, 45, 130)) * np.linspace(0, size, 130))
    drawn = np.float32(np.rint(128 * drawn) / 128)
    expected = corrected(drawn.astype(np.float64), network, 480)
    for isa in ISAS:
        found = Restoration(network, 480).correction(drawn, Device(threads=1, isa=isa))
        np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize("shape", [(3, 131, 250), (1, 65, 129)], ids=str)
def test_all_machines_and_threads_agree(network: int, shape: tuple[int, int, int]) -> None:
    drawn, restoration = tile(shape, 400), Restoration(network, 400)
    first = restoration.correction(drawn, Device(threads=1, isa="portable"))
    for isa in ISAS:
        for threads in (1, 2, 3):
            np.testing.assert_array_equal(first, restoration.correction(drawn, Device(threads=threads, isa=isa)))


@pytest.mark.parametrize("network", NETWORKS)
def test_the_page_names_the_networks(network: int) -> None:
    data = (PARTS / f"restoration{network}.bin").read_bytes()
    assert hashlib.sha256(data).hexdigest() in (ROOT / "docs" / "format.md").read_text()
