"""Where seeds should show a picture and where texture does it for less: weights of the seeds' squared errors.

A short fit shows what seeds would take from texture. In each superblock of texture, ρ is what they save it,
squared error plus λ times bits, over what their own bits cost. Where ρ is small, seeds count less, so that fewer are
placed and texture shows what they leave; edges and smooth ground keep theirs.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.tile.texture_steps import TUNINGS
from sgicodec.model.layout import SeedLayout, adaptive_layout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.texture import ROOT_LOG
from sgicodec.model.texture_symbols import TextureSteps
from sgicodec.profiles.fit_settings import FitSettings, Phase
from sgicodec.rdoq.texture import NO_SPLIT_SEARCH, TextureSearch, superblock_planes

__all__ = [
    "BLEND",
    "MIN_WEIGHT",
    "POSITION_BITS",
    "TextureCosts",
    "estimated_cost",
    "of_pixels",
    "seed_superblocks",
    "seed_weights",
    "smoothed",
    "superblock_weights",
]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

SCOUT_SHARE = 2.0
"""λ of the short fit, in the λ of the encode (docs/notes/2026-11-texture-share.md)."""
SCOUT_PHASES = (Phase(12, level=1), Phase(12, rounding="noise", rate=True, learn_steps=True, prune=2))
SCOUT_SPLIT = 6.0
"""Its `FitSettings.split`: in so few steps, seeds of larger cells come nearer to what they can be. 24 steps do nearly
as well as 110 (docs/notes/2026-11-texture-share.md)."""
POSITION_BITS = 3.5
"""What the position of a seed adds to its bits."""
FULL, FULL_ESTIMATED, POWER, MIN_WEIGHT = 0.5, 0.74, 3.0, 1 / 32
"""ρ of the short fit from which seeds count in full, searched and estimated, how fast they count less below it, and the
least. Where texture is searched, seeds are handed over later, so that a fit may begin with more of them
(docs/notes/2026-11-texture-share.md; 0.5: 2026-11-seeds-for-the-eye.md).
"""
CALM_BITS = 8.0
"""Added to the bits of seeds and to those that they save in each superblock; where texture alone saves fewer, seeds
count in full: there is nothing to share.
"""


def seed_superblocks(layout: SeedLayout, shape: tuple[int, int]) -> NDArray[np.int64]:
    """The superblock [N] that each seed's centre lies in, row by row, of a texture layer with superblocks [rows,
    columns].
    """
    cell = layout.centre.astype(np.int64) >> ROOT_LOG
    rows, columns = shape
    superblock: NDArray[np.int64] = np.minimum(cell[:, 1], rows - 1) * columns + np.minimum(cell[:, 0], columns - 1)
    return superblock


@dataclass(frozen=True)
class TextureCosts:
    """What texture costs over each superblock [rows, columns] in an encode at λ. target [C, H, W]: the picture less its
    base layer.
    """

    target: F32
    lmbda: float
    device: Device = ALL_CORES

    @cached_property
    def steps(self) -> TextureSteps:
        """Those of least squared error."""
        tuning = TUNINGS["psnr"]
        return tuning.steps(tuning.step(self.lmbda), len(self.target))

    def over(self, residual: F32) -> F64:
        """As the search finds it, over what seeds leave [C, H, W]."""
        search = TextureSearch(residual, self.device, NO_SPLIT_SEARCH)
        costs = search.costs(self.steps, TUNINGS["psnr"].squared_steps)
        return np.asarray(costs * np.square(self.steps.of_channels[0]), np.float64)

    def estimated_over(self, residual: F32) -> F64:
        """As it is estimated, in a tenth of the time."""
        return estimated_cost(residual, self.lmbda)[0]

    @cached_property
    def without_seeds(self) -> F64:
        """As the search finds it over the target."""
        return self.over(self.target)


def seed_weights(spec: ModelSpec, fit: FitSettings, costs: TextureCosts, family: int, exact: bool) -> F32 | None:
    """Weights [H, W] up to 1 of the seeds' squared errors in the target of `costs`; None where all are 1. exact:
    whether texture is searched, instead of an estimate of what it costs.
    """
    target, lmbda = costs.target, costs.lmbda
    fit = replace(fit, lmbda=SCOUT_SHARE * lmbda)
    device, busy = costs.device, int(exact and costs.device.cores > 1)
    with _searched_meanwhile(costs) if busy else nullcontext():
        residual, layout, bits = _scout(spec, fit, target, family, device.with_threads(device.cores - busy))
        alone, nothing = estimated_cost(target, lmbda)
        left = costs.over(residual) if exact else costs.estimated_over(residual)
    full, alone = (FULL, costs.without_seeds) if exact else (FULL_ESTIMATED, alone)
    spent = np.bincount(seed_superblocks(layout, left.shape), weights=np.full(len(layout), bits), minlength=left.size)
    price, calm = lmbda * np.asarray(spent, np.float64).reshape(left.shape), lmbda * CALM_BITS
    weights = superblock_weights(np.where(nothing - alone < calm, price, alone - left), price, calm, full)
    return None if weights.min() > _ALL else of_pixels(weights, target.shape[1:])


@contextmanager
def _searched_meanwhile(costs: TextureCosts) -> Iterator[None]:
    """The search over the target runs on a thread of its own meanwhile."""
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1) as executor:
        executor.submit(lambda: costs.without_seeds)
        yield


def superblock_weights(saved: F64, price: F64, calm: float, full: float = FULL) -> F64:
    """Weights of superblocks [rows, columns] where seeds save texture this much and cost so much, in squared error;
    `calm` is added to both; full: ρ from which seeds count in full.
    """
    rho = (np.maximum(smoothed(saved, _NEAR), 0) + calm) / (smoothed(price, _NEAR) + calm)
    octaves = np.clip(POWER * np.log2(rho / full), np.log2(MIN_WEIGHT), 0)
    return np.exp2(smoothed(octaves, BLEND))


def smoothed(plane: F64, sigma: float) -> F64:
    """A plane convolved with a Gaussian of this σ, in its samples, mirrored at its borders."""
    reach = int(4 * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        width = [(0, 0), (0, 0)]
        width[axis] = (reach, reach)
        padded, size = np.pad(plane, width, mode="symmetric"), plane.shape[axis]
        plane = sum(k * np.take(padded, range(i, i + size), axis) for i, k in enumerate(kernel))  # type: ignore[assignment]
    return plane


def estimated_cost(residual: F32, lmbda: float) -> tuple[F64, F64]:
    """What texture for λ would cost over each superblock [rows, columns] of a residual [C, H, W], squared error plus λ
    times bits, and what no texture would: as if all its blocks were cosine transforms of 16×16 pixels.
    """
    step = (lmbda / _ESTIMATED_STEPS) ** 0.5
    planes = superblock_planes(residual) / np.float32(step)
    channels, rows, columns = len(planes), planes.shape[1] >> ROOT_LOG, planes.shape[2] >> ROOT_LOG
    half = 1 << (ROOT_LOG - 1)
    blocks = planes.reshape(channels, 2 * rows, half, 2 * columns, half)
    cosines = _cosines(half)
    squares = np.square(cosines @ blocks.transpose(0, 1, 3, 2, 4) @ cosines.T)
    # λ times the bits of a symbol with its zeros, and the error that it leaves, in squared steps
    coded = 0.35 + 0.075 * np.log2(np.maximum(squares, 0.25))
    shape = channels, rows, 2, columns, 2, half, half
    cost, nothing = (
        step * step * part.reshape(shape).sum((0, 2, 4, 5, 6), dtype=np.float64)
        for part in (np.minimum(squares, coded), squares)
    )
    return cost, nothing


def _cosines(size: int) -> F32:
    """The orthonormal DCT-II [size, size]."""
    rows = np.cos(np.pi * np.outer(np.arange(size), np.arange(size) + 0.5) / size)
    rows[0] *= 0.5**0.5
    return np.asarray((2 / size) ** 0.5 * rows, np.float32)


def of_pixels(weights: F64, shape: tuple[int, ...]) -> F32:
    """Superblocks' weights for each pixel [H, W], linear between their centres."""
    side = 1 << ROOT_LOG
    for axis in (0, 1):
        at = np.clip((np.arange(shape[axis]) + 0.5) / side - 0.5, 0, weights.shape[axis] - 1)
        low = np.minimum(at.astype(np.int64), max(weights.shape[axis] - 2, 0))
        high = np.minimum(low + 1, weights.shape[axis] - 1)
        part = (at - low).reshape((-1, 1) if axis == 0 else (1, -1))
        weights = (1 - part) * weights.take(low, axis) + part * weights.take(high, axis)
    return np.ascontiguousarray(weights, np.float32)


def _scout(
    spec: ModelSpec, fit: FitSettings, target: F32, family: int, device: Device
) -> tuple[F32, SeedLayout, float]:
    """What a short fit leaves [C, H, W], where its seeds are, and the bits of a seed, its position included."""
    from sgicodec.bitstream.parts.prior import load_prior
    from sgicodec.fit.trainer import Trainer

    fit = replace(fit, phases=SCOUT_PHASES, split=SCOUT_SPLIT)
    layout = adaptive_layout(target, fit.split_price * fit.lmbda)
    networks = load_prior(spec) if spec.context.prior else None
    trainer = Trainer(spec, fit, target, layout, family, networks, device=device)
    trainer.run()
    rendered = trainer.raster.forward(*trainer.seeds.gaussians(), target.shape[2], target.shape[1])
    bits = float(trainer.seed_bits().mean()) + POSITION_BITS
    return target - rendered, trainer.seeds.layout, bits


_ESTIMATED_STEPS = 0.11
"""λ in squared steps where the cost of texture is estimated (docs/notes/2026-11-texture.md)."""
_NEAR, BLEND = 0.7, 0.5
"""σ in superblocks: what is saved and paid is smoothed with the first, the weights' logarithms with the second."""
_ALL = 0.95
"""Weights above which all are taken to be 1, which takes faster code."""
