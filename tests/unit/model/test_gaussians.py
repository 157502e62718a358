"""Seeds to Gaussians against the paper's formulas and matrix functions, in numpy and in torch."""

import math
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.model.gaussians import MIN_VARIANCE, decoder_shapes, gaussians_from_seeds
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec


def inputs_of(spec: ModelSpec, seeds: int, dtype: Any, size: float = 1.0) -> tuple[Any, ...]:
    """Attributes, centres, cells and decoders."""
    rng = np.random.default_rng(seeds)
    decoders = {name: rng.normal(size=shape).astype(dtype) * 0.3 for name, shape in decoder_shapes(spec).items()}
    return (
        (rng.normal(size=(seeds, spec.attributes)) * size).astype(dtype),
        rng.uniform(0, 100, (seeds, 2)).astype(dtype),
        2.0 ** rng.integers(0, 7, seeds).astype(dtype),
        decoders,
    )


number = st.floats(-3, 3)


@given(number, number, number, st.sampled_from([1.0, 4.0, 64.0]))
def test_log_covariance_is_a_matrix_exponential(a: float, b: float, c: float, cell: float) -> None:
    spec = default_spec(1)
    attributes = np.array([[0.5, a, b, c, 0.25, -0.5]])
    means, covariances, colours = gaussians_from_seeds(
        spec, attributes, np.array([[10.0, 20.0]]), np.array([cell]), {}, np
    )
    values, vectors = np.linalg.eigh(np.array([[a + b, c], [c, a - b]]))
    expected = cell**2 * (vectors * np.exp(2 * values)) @ vectors.T + MIN_VARIANCE * np.eye(2)
    close = 1e-9 * np.linalg.norm(expected)
    np.testing.assert_allclose(covariances[0, [0, 1, 1, 2]], expected.reshape(-1), rtol=0, atol=close)
    np.testing.assert_allclose(means, [[10.0 + 0.25 * cell, 20.0 - 0.5 * cell]])
    assert colours.tolist() == [[0.5]]


def test_rotated_covariance_offsets_and_decoders() -> None:
    """Paper, equations 1 to 3, one seed and one Gaussian at a time."""
    spec = paper_spec(2, per_seed=3, features=7)
    attributes, centres, cell, decoders = inputs_of(spec, 6, np.float64)
    means, covariances, colours = gaussians_from_seeds(spec, attributes, centres, cell, decoders, np)
    for seed in range(6):
        feature, scales, offset = np.split(attributes[seed], [7, 11])
        outputs = {
            net: decoders[f"{net}.w2"] @ np.maximum(decoders[f"{net}.w1"] @ feature + decoders[f"{net}.b1"], 0)
            + decoders[f"{net}.b2"]
            for net in ("colour", "shape")
        }
        for k in range(3):
            at = 3 * seed + k
            np.testing.assert_allclose(colours[at], outputs["colour"][2 * k : 2 * k + 2])
            moved = [offset[2 * k + i] * max(scales[i], 0.0) * cell[seed] for i in range(2)]
            np.testing.assert_allclose(means[at], centres[seed] + moved)
            first, second, angle = outputs["shape"][3 * k : 3 * k + 3]
            deviation = [
                cell[seed] * max(s, 0.0) / (1 + math.exp(-t)) for s, t in zip(scales[2:], (first, second), strict=True)
            ]
            turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
            matrix = turn @ np.diag(deviation) @ np.diag(deviation).T @ turn.T + MIN_VARIANCE * np.eye(2)
            np.testing.assert_allclose(covariances[at], matrix[[0, 0, 1], [0, 1, 1]], rtol=1e-9, atol=1e-12)
