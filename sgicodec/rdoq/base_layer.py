"""The base layer after the fit: its Gaussians do not want the colours that the picture alone would."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import search_base
from sgicodec.bitstream.entropy.tables import frequency_tables
from sgicodec.bitstream.parts.arrays import base_errors
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.model.base import base_step, cubic_weights
from sgicodec.model.gaussians import colour_matrix
from sgicodec.rdoq.objective import Objective

__all__ = ["with_optimised_base"]

_PASSES = 2

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def with_optimised_base(objective: Objective, model: TileModel, residual: F32, lmbda: float) -> TileModel:
    """The model with its base layer moved to where error plus λ times bits is least, seeds staying as they are.

    `residual` is what the model leaves, as `Objective.residual` has it.
    """
    spec, (_, height, width) = objective.header.spec, objective.picture.shape
    if not model.base.size:
        return model
    _, rows, columns = model.base.shape
    down = cubic_weights(np.arange(height) + 0.5, rows, spec.base_cell)
    across = cubic_weights(np.arange(width) + 0.5, columns, spec.base_cell)
    lines = residual[:, :, :width] @ across.astype(np.float32)
    pull = np.ascontiguousarray(np.tensordot(np.array(colour_matrix(spec.channels)), down.T @ lines, axes=1))
    base = _searched(model.base, base_step(model.base_step), lmbda, down.T @ down, across.T @ across, pull)
    return replace(model, base=base)


def _searched(
    base: NDArray[np.int64], step: float, lmbda: float, down: F64, across: F64, pull: F64
) -> NDArray[np.int64]:
    tables, numbers = frequency_tables(), np.array(base, np.int64, order="C")
    for _ in range(_PASSES):
        search_base(
            numbers,
            np.array([tables.best(errors) for errors in base_errors(numbers)], np.int32),
            tables.support,
            tables.start,
            tables.symbol_bits,
            np.ascontiguousarray(down),
            np.ascontiguousarray(across),
            pull,
            step,
            lmbda,
            1,
        )
    return numbers
