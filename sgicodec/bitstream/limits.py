"""Limits of a tile, checked before memory or time is spent: a stream is hostile until shown otherwise.

The range coder makes symbols that cost nothing, so the length of a payload bounds no count by itself, and a header of
forty bytes can describe anything. The caps below hold what a sound stream needs many times over.
"""

from __future__ import annotations

import math

import numpy as np

from sgicodec.bitstream.parts.seed_tree import MAX_ROOTS
from sgicodec.errors import LimitError
from sgicodec.model.base import base_shape
from sgicodec.model.context import HashGrid, input_count, output_count
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import ROOT_LOG, SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.texture_symbols import roots_of

__all__ = ["check_model", "check_texture", "hash_counts", "max_seeds", "network_shapes"]

MAX_SAMPLES = 1 << 31
MAX_BASE_VALUES = 1 << 22
MAX_BASE_LINES = 1 << 20
"""Rows and columns of the base layer's planes, which are decoded diagonal by diagonal."""
MAX_WEIGHTS = 1 << 22
"""Weights of all networks together: what the most features, Gaussians and channels that can be asked for need."""
MAX_SIGNS = 1 << 22

FREE_VALUES = 1 << 25
"""Numbers (about 24 bytes each) that seeds may take while they are decoded, however short the payload."""
VALUES_PER_BYTE = 128
"""And how many more for each byte of payload; real seeds take two to ten bytes, and a hundred values each."""

MAX_TEXTURE_SAMPLES = 1 << 26
"""Pixels times channels of a tile with texture, whole roots counted: up to twelve bytes each while it is decoded."""


def check_model(spec: ModelSpec, width: int, height: int) -> None:
    """Raises LimitError if the products of the header's fields are beyond what a tile may hold."""
    _limit(width * height * spec.channels, MAX_SAMPLES, f"{width}×{height} pixels: samples")
    side = 1 << ROOT_LOG
    _limit(-(-width // side) * -(-height // side), MAX_ROOTS, f"{width}×{height} pixels: cells of {side} pixels")
    if spec.base_cell:
        rows, columns = base_shape(width, height, spec.base_cell)
        _limit(spec.channels * rows * columns, MAX_BASE_VALUES, "base layer: values")
        _limit(spec.channels * (rows + columns), MAX_BASE_LINES, "base layer: rows and columns of all channels")
    networks = [network_shapes(spec, step) for step in range(len(spec.context.steps))]
    weights = sum(math.prod(shape) for net in (decoder_shapes(spec), *networks) for shape in net.values())
    _limit(weights, MAX_WEIGHTS, "networks: weights")
    _limit(sum(hash_counts(spec, width, height)), MAX_SIGNS, "hash grid: signs")


def max_seeds(spec: ModelSpec, width: int, height: int, payload_bytes: int) -> int:
    """The most seeds that a tile may have, given the bytes of its payload."""
    values = (FREE_VALUES + VALUES_PER_BYTE * payload_bytes) // _values_per_seed(spec)
    return min(values, max(64, 2 * width * height))


def check_texture(channels: int, width: int, height: int) -> None:
    """Raises LimitError for a tile that is too large to have texture."""
    columns, rows = roots_of(width, height)
    _limit(columns * rows * channels << 10, MAX_TEXTURE_SAMPLES, f"{width}×{height} pixels: samples with texture")


def network_shapes(spec: ModelSpec, step: int) -> dict[str, tuple[int, ...]]:
    """Shapes of MLP_p's weights at a step of `ContextSpec.steps`."""
    names = spec.context.steps[step]
    inputs, hidden = input_count(spec, step), spec.context.hidden
    outputs = 2 * sum(output_count(spec, name) for name in names) + len(names)
    return {"w1": (hidden, inputs), "b1": (hidden,), "w2": (outputs, hidden), "b2": (outputs,)}


def hash_counts(spec: ModelSpec, width: int, height: int) -> list[int]:
    """Signs of every resolution of the hash grid."""
    context = spec.context
    if not context.hash_resolutions:
        return []
    nowhere = SeedLayout(np.zeros((0, 2), np.int32), np.zeros(0, np.int8))
    return [size * context.hash_features for size in HashGrid.at(context, nowhere, width, height).sizes]


def _values_per_seed(spec: ModelSpec) -> int:
    """Numbers held for each seed at a time: context, attributes, decoders and Gaussians."""
    context = 0
    for step in range(len(spec.context.steps)):
        shapes = network_shapes(spec, step)
        context = max(context, sum(shapes["w1"]) + shapes["b2"][0])
    if spec.context.hash_resolutions:
        context += 8 * (len(spec.context.hash_resolutions) + spec.context.hash_features)  # four corners of each cell
    return context + spec.attributes + spec.hidden + spec.per_seed * (spec.channels + 8)


def _limit(count: int, most: int, what: str) -> None:
    if count > most:
        raise LimitError(f"{what} are {count}; a tile holds at most {most}")
