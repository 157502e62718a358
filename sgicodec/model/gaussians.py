"""From seeds to Gaussians: in native code where seeds hold them, and as a reference for numpy and torch alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from sgicodec._native import MIN_VARIANCE, SHAPE_LIMIT, seed_gaussians
from sgicodec.arrays import F32, F64
from sgicodec.device import Device
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec

__all__ = [
    "MIN_VARIANCE",
    "decoder_parts",
    "decoder_shapes",
    "empty_gaussians",
    "gaussians_from_seeds",
    "model_gaussians",
]


def decoder_shapes(spec: ModelSpec) -> dict[str, tuple[int, ...]]:
    """Names and shapes of the decoders' weights: MLP_c and MLP_Σ, two linear layers each (paper, appendix A)."""
    if not spec.hidden:
        return {}
    shapes: dict[str, tuple[int, ...]] = {}
    for net, outputs in (("colour", spec.per_seed * spec.channels), ("shape", spec.per_seed * 3)):
        shapes[f"{net}.w1"] = (spec.hidden, spec.features)
        shapes[f"{net}.b1"] = (spec.hidden,)
        shapes[f"{net}.w2"] = (outputs, spec.hidden)
        shapes[f"{net}.b2"] = (outputs,)
    return shapes


def decoder_parts(spec: ModelSpec, flat: Any) -> dict[str, Any]:
    """The decoders' weights by name, as views of a flat array or tensor of all of them."""
    parts, at = {}, 0
    for name, shape in decoder_shapes(spec).items():
        count = math.prod(shape)
        parts[name] = flat[at : at + count].reshape(shape)
        at += count
    return parts


def empty_gaussians(count: int, channels: int) -> tuple[F32, F32, F32]:
    """Memory for means [count, 2], covariances [count, 3] and colours [count, C]."""
    means, covariances, colours = (np.empty((count, size), np.float32) for size in (2, 3, channels))
    return means, covariances, colours


def model_gaussians(
    spec: ModelSpec, values: F32 | F64, layout: SeedLayout, decoders: Mapping[str, F32], device: Device
) -> tuple[F32, F32, F32]:
    """All N·K Gaussians of seeds with attributes `values` [N, d_A], as of `gaussians_from_seeds`, to be rendered."""
    if not spec.plain:
        arrays = values.astype(np.float32), layout.centre, layout.cell, decoders
        means, covariances, colours = map(np.ascontiguousarray, gaussians_from_seeds(spec, *arrays, np))
        return means, covariances, colours
    means, covariances, colours = empty_gaussians(len(layout), spec.channels)
    places = np.ascontiguousarray(values, np.float64), layout.half_pixels, layout.log_size
    seed_gaussians(*places, device.threads, device.isa, means, covariances, colours)
    return means, covariances, colours


def gaussians_from_seeds(
    spec: ModelSpec,
    attributes: Any,
    centres: Any,
    cell: Any,
    decoders: Mapping[str, Any],
    xp: Any,
) -> tuple[Any, Any, Any]:
    """All N·K Gaussians of N seeds (paper, equations 1 to 3).

    attributes [N, d_A] as `spec.groups` lays them out, centres [N, 2] and cell sizes [N] in pixels, decoder weights by
    the names of `decoder_shapes`; `xp` is numpy or torch. Returns means [N·K, 2]
    pixels, covariances [N·K, 3] (xx, xy, yy) pixels², colours [N·K, C].
    """
    n, k = attributes.shape[0], spec.per_seed
    offsets = attributes[:, spec.group("offset").columns].reshape(n, k, 2)
    if spec.plain:
        colours = attributes[:, spec.group("colour").columns]
        xx, xy, yy = _log_covariance(attributes[:, None, spec.group("shape").columns], cell[:, None], xp)
    else:
        features = attributes[:, : spec.features]
        colours = _decode(features, decoders, "colour", xp).reshape(n * k, spec.channels)
        shapes = _decode(features, decoders, "shape", xp).reshape(n, k, 3)
        scales = xp.clip(attributes[:, spec.group("scales").columns], 0.0, None)
        offsets = offsets * scales[:, None, :2]
        xx, xy, yy = _rotated_covariance(shapes, scales[:, None, 2:], cell[:, None], xp)
    means = centres[:, None, :] + cell[:, None, None] * offsets
    covariances = xp.stack([xx + MIN_VARIANCE, xy, yy + MIN_VARIANCE], -1)
    return means.reshape(n * k, 2), covariances.reshape(n * k, 3), colours


def _decode(features: Any, decoders: Mapping[str, Any], net: str, xp: Any) -> Any:
    hidden = features @ decoders[f"{net}.w1"].T + decoders[f"{net}.b1"]
    hidden = xp.maximum(hidden, xp.zeros_like(hidden))
    return hidden @ decoders[f"{net}.w2"].T + decoders[f"{net}.b2"]


def _log_covariance(shapes: Any, cell: Any, xp: Any) -> tuple[Any, Any, Any]:
    """Σ = h² exp(2M), M = [[a+b, c], [c, a−b]] in closed form: no angle wraps, no axes swap, zero is round."""
    a = xp.clip(shapes[..., 0], -SHAPE_LIMIT, SHAPE_LIMIT)
    b, c = shapes[..., 1], shapes[..., 2]
    rho = xp.sqrt(b * b + c * c + 1e-12)
    shrink = xp.clip(rho, 0.0, SHAPE_LIMIT) / rho
    rho = rho * shrink
    grow, fall = xp.exp(2 * (a + rho)), xp.exp(2 * (a - rho))
    mean, half = 0.5 * (grow + fall), 0.5 * (grow - fall) / rho * shrink
    area = cell * cell
    return area * (mean + half * b), area * half * c, area * (mean - half * b)


def _rotated_covariance(shapes: Any, scales: Any, cell: Any, xp: Any) -> tuple[Any, Any, Any]:
    """Σ = R S Sᵀ Rᵀ with s = h · s_a · sigmoid(s_base) and a rotation θ (paper, equations 2 and 3)."""
    deviation = cell[..., None] * scales / (1.0 + xp.exp(-xp.clip(shapes[..., :2], -SHAPE_LIMIT, SHAPE_LIMIT)))
    cos, sin = xp.cos(shapes[..., 2]), xp.sin(shapes[..., 2])
    first, second = deviation[..., 0] ** 2, deviation[..., 1] ** 2
    xx = cos * cos * first + sin * sin * second
    yy = sin * sin * first + cos * cos * second
    return xx, cos * sin * (first - second), yy
