"""The quantisation proxy: noise or rounding on the attributes that train, and the bits that they will take.

Inputs of the context model MLP_p are floats in units of 2^-6 here; docs/format.md, "Context model", has them in the
integers of coding. Of a seed's decoded values a *summary* enters: three opponent colours and three shape numbers, so
that one network serves any C.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec._native import (
    AMPLITUDE_ZERO,
    COLOUR_GAIN_BITS,
    DEAD_ZONE,
    DEAD_ZONE_LIMIT,
    INPUT_LIMIT,
    LOUDNESS_ZERO,
    MIN_MASS,
    OCTAVE_LIMIT,
    OFFSET_LIMIT,
    REFINE_LIMIT,
    SCALE_ZERO,
)
from sgicodec.fit.noise import NoiseKey, hashed_noise
from sgicodec.fit.step_sizes import base_counts, gamma_names
from sgicodec.model.context import INPUT_BITS, LEVELS, hash_grid, level_inputs, neighbour_table
from sgicodec.model.layout import SeedLayout
from sgicodec.model.quantization import (
    FRACTION_BITS,
    PER_OCTAVE,
    STEP_COUNT,
    STEP_ZERO,
)
from sgicodec.model.spec import Group, ModelSpec
from sgicodec.model.steps import follows_amplitude
from sgicodec.profiles.fit_settings import Rounding
from tests.support.page_attributes import WEIGHTS
from tests.support.torch_step.context_net import ContextNet

_MIN_STEP, _GREATEST_STEP = (2.0 ** ((index - STEP_ZERO) / PER_OCTAVE) for index in (0, STEP_COUNT - 1))
_MIN_SCALE = 2.0 ** (-SCALE_ZERO / PER_OCTAVE)
_MAX_REFINE = REFINE_LIMIT / PER_OCTAVE


@dataclass
class Sample:
    """Attributes as they will be decoded [N, d_A], and the bits of each seed [N]."""

    attributes: Tensor
    bits: Tensor


class QuantizationProxy:
    """Draws or rounds attributes as a stream will, with the context inputs of a layout.

    Neighbours enter with the values of the step before, refreshed every few steps: they move slowly, and all seeds
    can then be evaluated at once although coding visits them pass by pass.
    """

    refresh = 8

    def __init__(self, spec: ModelSpec, family: int) -> None:
        self.spec = spec
        self.bits_of = bits_laplace if family else bits_gaussian
        self.dead_zone = DEAD_ZONE if family else 0.0
        self.columns = {group.name: torch.from_numpy(output_columns(spec, group)) for group in spec.groups}
        self.age = 0

    def _base(self, steps: Tensor) -> dict[str, Tensor]:
        """log2 of the base steps of each group's outputs and cell sizes [U, LEVELS]."""
        counts = base_counts(self.spec)
        parts = torch.split(steps[: sum(counts)], counts)
        return {group.name: part.reshape(-1, LEVELS) for group, part in zip(self.spec.groups, parts, strict=True)}

    def noisy(self, values: dict[str, Tensor], steps: Tensor, scale: float, key: NoiseKey) -> Sample:
        """The attributes under noise of their base steps, without MLP_p: as published while bits do not count.

        At a level of the pyramid of this scale, offsets have that much smaller steps.
        """
        drawn = []
        for name, base in self._base(steps.detach()).items():
            q = self._spread(name, torch.exp2(base.T[self.level])) * (scale if name == "offset" else 1.0)
            drawn.append(values[name] + q * self._noise(name, key).to(q.dtype))
        return Sample(torch.cat(drawn, dim=1), torch.zeros(len(self.level)))

    def _gamma(self, steps: Tensor) -> dict[str, Tensor]:
        """γ of each group whose steps follow the amplitude."""
        names = gamma_names(self.spec)
        return dict(zip(names, steps[len(steps) - len(names) :], strict=True))

    def set_layout(self, layout: SeedLayout, colour_step: int, width: int, height: int) -> None:
        """Prepares everything that depends on where the seeds are."""
        context = self.spec.context
        self.level = torch.from_numpy(np.clip(layout.log_size.astype(np.int64), 0, LEVELS - 1))
        self.level_inputs = torch.from_numpy(level_inputs(layout, colour_step)).float()
        self.log_size = torch.from_numpy(layout.log_size.astype(np.float32))
        if context.neighbours:
            table = neighbour_table(context, layout)
            self.present = torch.from_numpy(table >= 0).float()
            table = np.maximum(table, 0)
            self.table = torch.from_numpy(table)
            self.offset = torch.from_numpy(nearest_offset(layout, table)).float()
        if context.hash_resolutions:
            entry, weight = map(torch.from_numpy, hash_grid(context, width, height).corners(layout.half_pixels))
            self.grid = entry.transpose(0, 1), weight.float().transpose(0, 1)
        self.age = 0

    def sample(
        self, values: dict[str, Tensor], net: ContextNet, steps: Tensor, rounding: Rounding, key: NoiseKey
    ) -> Sample:
        """Draws (noise) or rounds the attributes `values` and counts their bits; steps as `step_sizes.flat_steps`."""
        if not self.age:
            with torch.no_grad():
                self.common = self._common_inputs(values)
        self.age = (self.age + 1) % self.refresh
        decoded: dict[str, Tensor] = {}
        costs: dict[str, tuple[Tensor, Tensor, Tensor]] = {}
        bases, gammas = self._base(steps), self._gamma(steps)
        for number, stage in enumerate(self.spec.context.steps):
            mean, scale, refine = self._predict(net, number, decoded)
            start = 0
            for position, name in enumerate(stage):
                base = bases[name]  # [U, LEVELS]
                units = slice(start, start + base.shape[0])
                start += base.shape[0]
                log_base = base.T[self.level]  # [N, U]
                if follows_amplitude(self.spec, name):
                    loudness = self._amplitude(decoded["colour"].detach()) - AMPLITUDE_ZERO / PER_OCTAVE
                    log_step = log_base - gammas[name] * loudness[:, None]
                else:
                    log_step = log_base
                log_step = log_step + refine[:, position : position + 1].clamp(-_MAX_REFINE, _MAX_REFINE)
                q = self._spread(name, torch.exp2(log_step).clamp(_MIN_STEP, _GREATEST_STEP))
                q_base = torch.exp2(log_base)
                m = self._spread(name, mean[:, units] * q_base)
                s = self._spread(name, torch.exp2(scale[:, units].clamp(-OCTAVE_LIMIT, OCTAVE_LIMIT)) * q_base)
                s = torch.maximum(s, q * _MIN_SCALE)
                noise = self._noise(name, key).to(q.dtype) if rounding == "noise" else None
                value = self._perturb(values[name], m, q, s, noise)
                q_rate = q.detach() if rounding == "round" else q
                costs[name] = (value - m, q_rate, s)
                decoded[name] = value
        bits = self.bits_of(*(torch.cat(parts, dim=1) for parts in zip(*costs.values(), strict=True))).sum(dim=1)
        return Sample(torch.cat([decoded[group.name] for group in self.spec.groups], dim=1), bits)

    def _spread(self, name: str, predicted: Tensor) -> Tensor:
        """From MLP_p's outputs [N, U] to a group's attributes [N, size]."""
        return predicted[:, self.columns[name]]

    def _noise(self, name: str, key: NoiseKey) -> Tensor:
        """Of a group's attributes [N, size], in steps."""
        columns = self.spec.group(name).columns
        drawn = [hashed_noise(key, column, len(self.level)) for column in range(columns.start, columns.stop)]
        return torch.from_numpy(np.stack(drawn, axis=1))

    def _perturb(self, value: Tensor, m: Tensor, q: Tensor, s: Tensor, noise: Tensor | None) -> Tensor:
        """Values under noise in steps, or rounded where there is none."""
        if noise is not None:
            return value + q * noise
        with torch.no_grad():
            u = (value - m) / q
            towards_zero = (self.dead_zone * q / s).clamp_max(DEAD_ZONE_LIMIT)
            shift = m + q * u.sign() * (u.abs() + 0.5 - towards_zero).floor() - value
        return value + shift

    def summary(self, values: dict[str, Tensor]) -> Tensor:
        """Summaries [N, SUMMARY] in input units."""
        colour, shape = values["colour"], values["shape"]
        one = float(1 << INPUT_BITS)
        k, channels = self.spec.per_seed, self.spec.channels
        mixed = colour.reshape(-1, k, channels).mean(1)
        mixed = mixed[:, :3] if channels >= 3 else torch.cat([mixed[:, :1], torch.zeros(len(mixed), 2)], 1)
        loudness = (self._amplitude(colour) + LOUDNESS_ZERO)[:, None]
        shapes = shape.reshape(-1, k, 3).mean(1)
        return torch.cat(
            [(mixed * (one * 2**COLOUR_GAIN_BITS)).clamp(-INPUT_LIMIT, INPUT_LIMIT), loudness * one, shapes * one], 1
        )

    @staticmethod
    def _amplitude(colour: Tensor) -> Tensor:
        return 0.5 * torch.log2((colour * colour).sum(1).clamp_min(2.0**-FRACTION_BITS))

    def _common_inputs(self, values: dict[str, Tensor]) -> Tensor:
        blocks = [self.level_inputs]
        if self.spec.context.neighbours:
            seen = self.table, self.present, self.log_size, self.offset
            blocks.append(neighbour_inputs(self.summary(values), *seen))
        return torch.cat(blocks, dim=1)

    def _predict(self, net: ContextNet, number: int, decoded: dict[str, Tensor]) -> tuple[Tensor, Tensor, Tensor]:
        """MLP_p at one coding stage."""
        blocks = [self.common]
        if self.spec.context.hash_resolutions:
            blocks.append(net.hash_features(*self.grid))
        if number:
            known = {name: value.detach() for name, value in decoded.items()}
            if "shape" not in known:
                known["shape"] = torch.zeros(len(self.level), 3 * self.spec.per_seed)
            blocks.append(own_inputs(self.summary(known), number))
        return net.forward(number, torch.cat(blocks, dim=1))


def output_columns(spec: ModelSpec, group: Group) -> NDArray[np.int64]:
    """Which of MLP_p's outputs of its kind predicts each attribute of a group [size]: channels beyond three, and those
    of pictures with fewer than three, share luma's.
    """
    channel = np.arange(group.size)
    is_shared = spec.plain and group.name == "colour"
    return np.where((channel < 3) & (spec.channels >= 3), channel, 0) if is_shared else channel


def neighbour_inputs(summary: Tensor, table: Tensor, present: Tensor, log_size: Tensor, offset: Tensor) -> Tensor:
    """Inputs of all seeds from their neighbours [N, NEIGHBOUR_INPUTS].

    summary [N, SUMMARY] of decoded seeds; table, present [N, k]; log_size [N]; offset [N, 2] from each seed to its
    nearest neighbour in its own cells, input units.
    """
    share = present * torch.tensor(WEIGHTS[: table.shape[1]], dtype=present.dtype) / 16
    rows = summary[table]  # [N, k, SUMMARY]
    count = share.sum(1, keepdim=True) * (1 << INPUT_BITS)
    weighted = (rows * share[..., None]).sum(1)
    sizes = (rows[..., [0, 1, 2, 5, 6]].abs() * share[..., None]).sum(1)
    level = ((log_size[table] - log_size[:, None]) * share).sum(1, keepdim=True) * (1 << INPUT_BITS)
    return torch.cat([count, weighted, sizes, level, rows[:, 0] * present[:, :1], offset * present[:, :1]], dim=1)


def own_inputs(summary: Tensor, step: int) -> Tensor:
    """What a seed's own earlier groups say [n, 7 or 12]: colours, their size and, after the shape, the shape."""
    columns = [summary[:, :3], summary[:, :3].abs(), summary[:, 3:4]]
    if step >= 2:
        columns += [summary[:, 4:7], summary[:, 5:7].abs()]
    return torch.cat(columns, dim=1)


def nearest_offset(layout: SeedLayout, table: NDArray[np.int32]) -> NDArray[np.int64]:
    """From each seed to its nearest neighbour, in its own cells, input units, at most OFFSET_LIMIT cells [N, 2]."""
    points = layout.half_pixels.astype(np.int64)
    difference = points[table[:, 0]] - points
    scaled = (difference << INPUT_BITS) >> (layout.log_size.astype(np.int64) + 1)[:, None]
    clipped: NDArray[np.int64] = np.clip(scaled, -OFFSET_LIMIT << INPUT_BITS, OFFSET_LIMIT << INPUT_BITS)
    return clipped


def bits_gaussian(deviation: Tensor, step: Tensor, scale: Tensor) -> Tensor:
    """−log2 of the Gaussian's mass in [d − q/2, d + q/2] (paper, equation 10); all tensors alike in shape.

    Written with |d| so that a tail's mass is no difference of numbers near 1.
    """
    size = deviation.abs()
    nearer = torch.special.ndtr((0.5 * step - size) / scale)
    beyond = torch.special.ndtr((-0.5 * step - size) / scale)
    return -torch.log2((nearer - beyond).clamp_min(MIN_MASS))


def bits_laplace(deviation: Tensor, step: Tensor, scale: Tensor) -> Tensor:
    """−log2 of the Laplacian's mass in [d − q/2, d + q/2]; `scale` is its standard deviation.

    Written with |d| so that neither tail cancels.
    """
    rate, size, half = math.sqrt(2.0) / scale, deviation.abs(), 0.5 * step
    inside = half - size
    near = 0.5 * torch.exp(-rate * inside.abs())  # mass between the mean and the nearer edge, from its tail
    far = 0.5 * torch.exp(-rate * (half + size))
    return -torch.log2((torch.where(inside > 0, 1.0 - near, near) - far).clamp_min(MIN_MASS))
