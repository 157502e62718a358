"""Seeds → Gaussians in native code and their gradients, over all that a stream can hold, against float64."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
import torch
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scenes import ISAS

from sgicodec import _native
from sgicodec.model.context import input_count
from sgicodec.model.gaussians import gaussians_from_seeds
from sgicodec.profiles.default import default_spec

F32, F64 = NDArray[np.float32], NDArray[np.float64]

SPEC = default_spec(3)
COUNT = 20  # no multiple of any vector
HIDDEN = 1
GREATEST = 2.0**21 + 2.0**13
"""Symbols up to 2^20 in steps up to 2, means up to 2^13."""

ROUNDINGS = 16 * 2.0**-24
"""What float32 may lose: an exponential is off by up to four half units of its last place, and a gradient holds twice
the difference of two. Its exponent's own rounding comes on top, times the exponent: see `tolerance`.
"""

FLUSHED = 8 * float(np.finfo(np.float32).tiny)
"""Sums of what is too small for a normal number, which native code takes for zero."""


class Seeds(NamedTuple):
    """colour [N, 3], shape [N, 3], offset [N, 2]; centres in half pixels, log2 of cells; gradients of the Gaussians."""

    colour: F32
    shape: F32
    offset: F32
    half_pixels: NDArray[np.int32]
    log_size: NDArray[np.int8]
    up: tuple[F32, F32, F32]


number = st.one_of(
    st.floats(-GREATEST, GREATEST, width=32),
    st.floats(-13, 13, width=32),
    st.floats(-0.25, 0.25, width=32),  # nearly round, where differences cancel
)


@st.composite
def seeds(draw: st.DrawFn) -> Seeds:
    """A few shapes as hypothesis likes them, the rest at random."""
    shapes = draw(st.lists(st.tuples(number, number, number), min_size=1, max_size=6))
    furthest = abs(draw(number))
    rng = np.random.default_rng(len(shapes))
    half_pixels = np.arange(2 * COUNT, dtype=np.int32).reshape(COUNT, 2) * 7
    colour, offset = rng.uniform(-furthest, furthest, (COUNT, 3)), rng.uniform(-furthest, furthest, (COUNT, 2))
    up = tuple(rng.uniform(-1, 1, (COUNT, columns)).astype(np.float32) for columns in (2, 3, 3))
    return Seeds(
        colour.astype(np.float32),
        np.resize(np.array(shapes, np.float32), (COUNT, 3)),
        offset.astype(np.float32),
        half_pixels,
        rng.integers(0, 7, COUNT).astype(np.int8),
        (up[0], up[1], up[2]),
    )


def native(isa: str, s: Seeds) -> tuple[tuple[F32, F32, F32], tuple[F32, F32, F32]]:
    """Means, covariances and colours; gradients of colour, shape and offset. No network runs."""
    inputs = [input_count(SPEC, step) for step in range(3)]
    outputs = [2 * predicted + 1 for predicted in (3, 3, 2)]
    first = np.zeros(HIDDEN * sum(inputs), np.float32)
    rest = np.zeros(sum(HIDDEN * (1 + count) + count for count in outputs), np.float32)
    step = _native.SeedFit(isa, 1, 3, HIDDEN, first, rest)
    step.set_layout(s.half_pixels, s.log_size, np.full((COUNT, 1), -1, np.int32), 0)
    steps = np.zeros(8 * _native.LEVELS + 2, np.float32)
    gaussians = np.empty((COUNT, 2), np.float32), np.empty((COUNT, 3), np.float32), np.empty((COUNT, 3), np.float32)
    values = s.colour, s.shape, s.offset
    step.forward(*values, steps, 0, 0, False, False, *gaussians)
    gradients = np.empty_like(s.colour), np.empty_like(s.shape), np.empty_like(s.offset)
    step.backward(*s.up, 0.0, *gradients, np.empty_like(steps))
    return gaussians, gradients


def expected(s: Seeds) -> tuple[list[F64], F64]:
    """The Gaussians, and the gradient of all attributes [N, 8], in float64."""
    attributes = torch.from_numpy(np.concatenate([s.colour, s.shape, s.offset], axis=1)).double().requires_grad_()
    centre = torch.from_numpy(s.half_pixels).double() / 2
    cell = 2.0 ** torch.from_numpy(s.log_size).double()
    gaussians = gaussians_from_seeds(SPEC, attributes, centre, cell, {}, torch)
    sum((g * torch.from_numpy(up)).sum() for g, up in zip(gaussians, s.up, strict=True)).backward()
    return [g.detach().numpy() for g in gaussians], attributes.grad.numpy()


def limited(s: Seeds) -> tuple[F64, F64]:
    """The exponent 2 (a + r) of each seed's larger axis [N], and by how much (b, c) shrinks [N]."""
    a, b, c = s.shape.astype(np.float64).T
    radius = np.hypot(b, c)
    shrink = _native.SHAPE_LIMIT / np.maximum(radius, _native.SHAPE_LIMIT)
    return 2 * (np.clip(a, -_native.SHAPE_LIMIT, _native.SHAPE_LIMIT) + radius * shrink), shrink


def tolerance(s: Seeds) -> F64:
    """Of covariances per pixel² of their larger axis [N]."""
    a, b, c = s.shape.astype(np.float64).T
    sizes = 2 * np.minimum(np.abs(a), _native.SHAPE_LIMIT) + 2 * np.minimum(np.hypot(b, c), _native.SHAPE_LIMIT)
    return ROUNDINGS * (1 + sizes)


@pytest.mark.parametrize("isa", ISAS)
@given(s=seeds())
def test_gaussians_are_those_of_float64(isa: str, s: Seeds) -> None:
    (means, covariances, colours), _ = native(isa, s)
    (want_means, want_covariances, want_colours), _ = expected(s)
    exponent, _ = limited(s)
    axis = 4.0**s.log_size * np.exp(exponent) + _native.MIN_VARIANCE
    assert np.all(np.abs(covariances - want_covariances) <= (axis * tolerance(s))[:, None])
    reach = np.abs(s.half_pixels) + 2.0 ** s.log_size[:, None] * np.abs(s.offset)
    assert np.all(np.abs(means - want_means) <= ROUNDINGS * (1 + reach))
    assert np.all(np.abs(colours - want_colours) <= ROUNDINGS * np.abs(s.colour).sum(axis=1, keepdims=True) + FLUSHED)


@pytest.mark.parametrize("isa", ISAS)
@given(s=seeds())
def test_gradients_are_those_of_float64(isa: str, s: Seeds) -> None:
    """On a limit itself neither side has the only gradient."""
    exponent, shrink = limited(s)
    radius = np.hypot(s.shape[:, 1].astype(np.float64), s.shape[:, 2])
    assume(not np.any(np.abs(s.shape[:, 0]) == _native.SHAPE_LIMIT))
    assume(not np.any(np.abs(radius - _native.SHAPE_LIMIT) < 1e-5))
    _, (colour, shape, offset) = native(isa, s)
    _, want = expected(s)
    axis = 4.0**s.log_size * np.exp(exponent)
    allowed = (axis * tolerance(s))[:, None] * np.stack([np.ones_like(shrink), shrink, shrink], axis=1)
    assert np.all(np.abs(shape - want[:, 3:6]) <= allowed + FLUSHED)
    assert np.all(np.abs(colour - want[:, :3]) <= ROUNDINGS * np.abs(s.up[2]).sum(axis=1, keepdims=True))
    np.testing.assert_allclose(offset, want[:, 6:], rtol=1e-6)
