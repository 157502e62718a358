"""Where a fit starts: attributes of seeds that have seen nothing yet, and weights of the decoders."""

from __future__ import annotations

import math

import numpy as np

from sgicodec.arrays import F32
from sgicodec.model.distinct import distinct
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import ROOT_LOG, SeedLayout, cell_sums
from sgicodec.model.spec import ModelSpec

_OFFSET_SPREAD = 0.6
"""Of the K Gaussians of a seed at the start, in units of s_o. All seeds begin with the same offsets, so that MLP_p can
say where they are: drawn at random they cost 8 % more bytes for 0.6 dB less (docs/notes/2026-11-paper-profile.md)."""


def fresh_values(spec: ModelSpec, mean: F32, pixels: int) -> dict[str, F32]:
    """Attributes by group [n, size] of seeds whose cells hold `mean` [n, C], in a picture of `pixels` pixels.

    A seed that holds one starts as a round Gaussian of half its cell and most of its cell's mean colour; others at
    f = 0 as published, with scales that cover the picture. K > 1 Gaussians start apart, by `_OFFSET_SPREAD`.
    """
    n = len(mean)
    values = {group.name: np.zeros((n, group.size), np.float32) for group in spec.groups}
    if spec.plain:
        values["colour"][:] = np.float32(0.7) * mean
        values["shape"][:, 0] = math.log(0.5)
    else:
        values["scales"] += np.float32(math.log(0.5 * math.sqrt(pixels / n)))
    if spec.per_seed > 1:
        values["offset"] += _spiral(spec.per_seed).reshape(-1)
    return values


def _spiral(count: int) -> F32:
    """Points [count, 2] evenly over a disc around 0, with a standard deviation of `_OFFSET_SPREAD` along each axis."""
    number = np.arange(count) + 0.5
    angle, radius = number * math.pi * (3 - math.sqrt(5)), 2 * _OFFSET_SPREAD * np.sqrt(number / count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1).astype(np.float32)


def fresh_decoders(spec: ModelSpec, rng: np.random.Generator) -> dict[str, F32]:
    """Weights of MLP_c and MLP_Σ: Xavier-uniform, zero biases, and nearly nothing out of MLP_c (gain 0.01, as
    published).
    """
    decoders = {}
    for name, shape in decoder_shapes(spec).items():
        if name.endswith("b1"):
            bound = np.float32(1.0 / math.sqrt(spec.features))
            decoders[name] = (rng.random(shape, np.float32) * 2 - 1) * bound
            continue
        if len(shape) == 1:
            decoders[name] = np.zeros(shape, np.float32)
            continue
        gain = 1.0 if name.endswith("w1") else 0.01 if name.startswith("colour") else 0.5
        bound = np.float32(gain * math.sqrt(6.0 / (shape[0] + shape[1])))
        decoders[name] = (rng.random(shape, np.float32) * 2 - 1) * bound
    return decoders


class CellMeans:
    """Means of planes [C, H, W] over the cells of seeds."""

    def __init__(self, planes: F32) -> None:
        self._planes, self._sums = planes, cell_sums(planes, ROOT_LOG).values

    def of(self, layout: SeedLayout) -> F32:
        """Means over each seed's cell, as far as it lies in the picture [N, C]."""
        channels, height, width = self._planes.shape
        corner, side = layout.corner.astype(np.int64), layout.cell.astype(np.int64)
        means = np.empty((len(layout), channels), np.float64)
        for level in distinct(layout.log_size).tolist():
            here = layout.log_size == level
            x, y = (corner[here] >> level).T
            means[here] = (self._sums[level] if level else self._planes)[:, y, x].T
        inside = np.minimum(corner + side[:, None], (width, height)) - corner
        return np.asarray(means / inside.prod(axis=1)[:, None], np.float32)
