"""Layers of networks on a GPU, whose kernels are compiled for the host, against float64."""

from __future__ import annotations

import numpy as np
import pytest
from fake_cuda import fake_gpu
from numpy.typing import NDArray

from sgicodec.fit.context_weights import layer_shapes
from sgicodec.fit.device_networks import DECODERS, Activations, DeviceNetworks
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.paper import paper_spec

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

SPEC = paper_spec(3, per_seed=2, features=17)


def weights_of(spec: ModelSpec) -> tuple[dict[str, F32], F32]:
    """Random ones by name, and flat in the order of sums."""
    [(w1, b1, w2, b2)] = layer_shapes(spec)
    shapes = decoder_shapes(spec) | {"context.b1": b1, "context.w2": w2, "context.b2": b2, "context.w1": w1}
    rng = np.random.default_rng(3)
    named = {name: rng.normal(0, 0.3, shape).astype(np.float32) for name, shape in shapes.items()}
    return named, np.concatenate([array.reshape(-1) for array in named.values()])


def expected(named: dict[str, F32], name: str, inputs: F32, up: F32) -> dict[str, F64]:
    """What a network says, and all gradients."""
    w1, b1, w2, b2 = (named[f"{name}.{part}"].astype(np.float64) for part in ("w1", "b1", "w2", "b2"))
    x, slopes = inputs.astype(np.float64), up.astype(np.float64)
    hidden = np.maximum(w1 @ x + b1[:, None], 0)
    below = (w2.T @ slopes) * (hidden > 0)
    said = w2 @ hidden + b2[:, None]
    sums = {"w1": below @ x.T, "b1": below.sum(1), "w2": slopes @ hidden.T, "b2": slopes.sum(1)}
    return {"said": said, "down": w1.T @ below} | {f"{name}.{part}": array for part, array in sums.items()}


def run(count: int, skipped: int = 0) -> tuple[dict[str, F64], dict[str, F64]]:
    """What all networks say and their gradients of `count` seeds, and what they should be, by name."""
    gpu, rng, (named, flat) = fake_gpu(), np.random.default_rng(count), weights_of(SPEC)
    networks = DeviceNetworks(gpu, SPEC, count)
    networks.load(flat)
    found, wanted, before = dict[str, F64](), dict[str, F64](), 0.5
    for name in (*DECODERS, "context"):
        (hidden, width), outputs = named[f"{name}.w1"].shape, len(named[f"{name}.b2"])
        inputs, up = (rng.normal(0, 1, (rows, count)).astype(np.float32) for rows in (width, outputs))
        less, adds = (skipped, False) if name == "context" else (0, True)
        slopes = gpu.put(np.full((width - less, count), before, np.float32))
        said, held, below = gpu.array((outputs, count)), gpu.array((hidden, count)), gpu.array((hidden, count))
        rows = Activations(gpu.put(inputs), held, said, gpu.put(up), below, slopes, adds, less)
        networks.forward(name, rows)
        networks.backward(name, rows)
        want = expected(named, name, inputs, up)
        found |= {f"{name} says": said.download(), f"{name} sees": slopes.download()}
        wanted[f"{name} says"] = want.pop("said")
        wanted[f"{name} sees"] = want.pop("down")[less:] + (before if adds else 0.0)
        wanted |= want
    ends = np.cumsum([array.size for array in named.values()])[:-1]
    parts = dict(zip(named, np.split(networks.sums(), ends), strict=True))
    return found | {name: part.reshape(named[name].shape) for name, part in parts.items()}, wanted


@pytest.mark.parametrize("count", [1, 31, 128, 129, 9000])
def test_they_are_products_of_matrices(count: int) -> None:
    found, wanted = run(count, skipped=9)
    assert found.keys() == wanted.keys()
    for name, want in wanted.items():
        assert np.linalg.norm(found[name] - want) <= 2e-6 * np.linalg.norm(want), name
