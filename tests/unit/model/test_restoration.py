"""Restoration is what docs/format.md says, for tiles of any size and any channels, on all instruction sets."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from restoration_reader import OPPONENT, PARTS, corrected, network_of
from scenes import ISAS

from sgicodec._native import restoration_last_inputs, restoration_last_layer
from sgicodec.device import Device
from sgicodec.errors import CorruptStreamError
from sgicodec.model.restoration import Restoration

ROOT = Path(__file__).parents[3]
NETWORKS = sorted(int(path.stem.removeprefix("restoration")) for path in PARTS.glob("restoration*.bin"))
SHAPES = [(3, 70, 130), (3, 1, 1), (3, 2, 200), (3, 200, 3), (1, 40, 50), (2, 40, 50), (4, 67, 125), (5, 64, 120)]


def tile(shape: tuple[int, int, int], step: int, seed: int = 0) -> np.ndarray:
    """Edges and noise, at places where no input of the network lies near the middle of two integers."""
    rng, (channels, rows, columns) = np.random.default_rng(seed), shape
    x, y = np.arange(columns) / 9, np.arange(rows)[:, None] / 7
    waves = np.sign(np.sin(x + y)) * 0.3 + 0.5 + rng.normal(size=shape) * 0.05
    waves[:, :1, :1] = 40.0  # far beyond white
    delta = 2.0 ** ((step - 480) / 32)
    if channels < 3:
        return np.asarray((np.rint(128 * waves / delta) + rng.uniform(-0.2, 0.2, shape)) * delta / 128, np.float32)
    seen = np.tensordot(OPPONENT, waves[:3], axes=1)
    seen = (np.rint(128 * seen / delta) + rng.uniform(-0.2, 0.2, seen.shape)) * delta / 128
    waves[:3] = np.tensordot(OPPONENT.T, seen, axes=1)
    return np.asarray(waves, np.float32)


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


def random_changes(network: int, layers: set[int]) -> tuple[np.ndarray, ...]:
    """Of these layers, of a size that is seen."""
    rng = np.random.default_rng(3)
    whole = [(len(weights), weights[0].size + 1) for weights in network_of(network).weights]
    sizes = [size if i in layers else (0, 0) for i, size in enumerate(whole)]
    return tuple(rng.integers(-20, 21, size).astype(np.int32) for size in sizes)


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize("layers", [{3}, {0}, {1, 2}, {0, 1, 2, 3}], ids=str)
@pytest.mark.parametrize("shape", [(3, 70, 130), (1, 40, 50)], ids=str)
def test_changes_are_what_the_page_says(network: int, layers: set[int], shape: tuple[int, int, int]) -> None:
    drawn, changes = tile(shape, 400), random_changes(network, layers)
    own, other = Restoration(network, 400).correction(drawn), Restoration(network, 400, changes).correction(drawn)
    assert np.abs(other - own).max() > 0.01
    expected = corrected(drawn.astype(np.float64), network, 400, changes)
    np.testing.assert_allclose(other, expected, rtol=1e-5, atol=1e-5)
    np.testing.assert_array_equal(Restoration(network, 400).correction(drawn), own)  # the shipped one stays


@pytest.mark.parametrize(("layer", "weights", "bias"), [(3, 700, 0), (1, -700, 0), (2, 0, 40000), (0, 40000, 0)])
def test_sums_must_fit(layer: int, weights: int, bias: int) -> None:
    changes = [np.zeros((0, 0), np.int32)] * 4
    shape = network_of(1).weights[layer].shape
    changes[layer] = np.zeros((shape[0], 9 * shape[1] + 1), np.int32)
    changes[layer][-1, :-1], changes[layer][-1, -1] = weights, bias
    with pytest.raises(CorruptStreamError, match="restoration"):
        Restoration(1, 400, tuple(changes)).correction(np.zeros((3, 4, 4), np.float32))


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize("shape", [(3, 70, 130), (1, 40, 250), (3, 1, 1)], ids=str)
def test_last_inputs_are_what_the_last_layer_sees(network: int, shape: tuple[int, int, int]) -> None:
    """Its weights times them are the correction, in some rows, with any number of threads."""
    drawn, rows = tile(shape, 400), range(shape[1] // 3, shape[1] // 3 + max(1, shape[1] // 2))
    weights, shift = restoration_last_layer(network)
    seen = restoration_last_inputs(drawn, network, 400, rows.start, len(rows), 1, "auto")
    np.testing.assert_array_equal(
        seen, restoration_last_inputs(drawn, network, 400, rows.start, len(rows), 3, "portable")
    )
    windows = sliding_window_view(seen.astype(np.int64), (3, 3), axis=(1, 2)).transpose(0, 3, 4, 1, 2)
    inputs = windows.reshape(weights.shape[1] - 1, -1)
    sums = (weights[:, :-1] @ inputs + 64 * weights[:, -1:]).reshape(3, len(rows), shape[2])
    sums = sums * 2.0 ** ((400 - 480) / 32 - shift)
    expected = np.tensordot(OPPONENT.T, sums, 1) if shape[0] >= 3 else sums[:1]
    found = Restoration(network, 400).correction(drawn)[:, rows.start : rows.stop]
    np.testing.assert_allclose(found[:3], expected, atol=1e-6)


@pytest.mark.parametrize("network", NETWORKS)
def test_the_page_names_the_networks(network: int) -> None:
    data = (PARTS / f"restoration{network}.bin").read_bytes()
    assert hashlib.sha256(data).hexdigest() in (ROOT / "docs" / "format.md").read_text()
