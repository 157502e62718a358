"""The inputs of the context model MLP_p while it trains: floats in units of 2^-6.

docs/format.md, "Context model", has them in the integers of coding. A seed's decoded values enter as a *summary*: three
opponent colours and three shape numbers, so that one network serves any C.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec._native import INPUT_BITS, OFFSET_LIMIT, neighbour_weight
from sgicodec.model.context import HashGrid
from sgicodec.model.layout import SeedLayout

__all__ = ["hash_inputs", "nearest_offset", "neighbour_inputs", "own_inputs"]


def neighbour_inputs(summary: Tensor, table: Tensor, present: Tensor, log_size: Tensor, offset: Tensor) -> Tensor:
    """Inputs of all seeds from their neighbours [N, NEIGHBOUR_INPUTS].

    summary [N, SUMMARY] of decoded seeds; table, present [N, k]; log_size [N]; offset [N, 2] from each seed to its
    nearest neighbour in its own cells, input units.
    """
    share = present * torch.tensor([neighbour_weight(rank) / 16 for rank in range(table.shape[1])], dtype=present.dtype)
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


def hash_inputs(grid: HashGrid, tables: list[Tensor], weight: Tensor) -> Tensor:
    """H(x_a) of all seeds by bilinear interpolation of ±1 features [N, L·F] (paper, equation 9)."""
    levels = zip(tables, grid.entry, weight, strict=True)
    mixed = [(table[entry] * share[..., None]).sum(1) for table, entry, share in levels]  # of [N, 4, F]
    return torch.cat(mixed, dim=1) * 2.0 ** (INPUT_BITS - 12)
