"""What the search changes in MLP_p: biases of two kinds of outputs, which leave all other predictions alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.tables import SCALES, frequency_tables
from sgicodec.model.context import output_columns
from sgicodec.model.distinct import distinct
from sgicodec.model.network import DIFFERENCE_SHIFT, IntNetwork
from sgicodec.model.quantization import PER_OCTAVE
from sgicodec.model.spec import ModelSpec
from sgicodec.rdoq.coordinate_descent import Symbols

__all__ = ["fitted_scales", "with_coarser_steps"]

_REACH = 8
"""Sixths of an octave by which scales may move."""


def with_coarser_steps(networks: tuple[IntNetwork, ...], octaves: float) -> tuple[IntNetwork, ...]:
    """Networks whose refinement r is larger by `octaves`, rounded to the stream's units: all steps grow."""
    return tuple(network.coarser(round(octaves * 2**DIFFERENCE_SHIFT)) for network in networks)


def fitted_scales(spec: ModelSpec, networks: tuple[IntNetwork, ...], coded: Symbols) -> tuple[IntNetwork, ...]:
    """Networks with a bias on every predicted scale, the one for which the symbols coded would have cost least."""
    fitted = []
    for group, network in zip(spec.groups, networks, strict=True):
        by_output = output_columns(spec, group.name)
        symbols, scale = coded.symbols[:, group.columns], coded.scale[:, group.columns]
        moves = np.arange(-_REACH, _REACH + 1)
        costs = np.stack([_bits(symbols, scale + move, coded.family) for move in moves])  # [moves, size]
        more = np.zeros(network.predicted, np.int64)
        for output in distinct(by_output):
            best = moves[np.argmin(costs[:, by_output == output].sum(axis=1))]
            more[output] = round(best * 2**DIFFERENCE_SHIFT / PER_OCTAVE)
        fitted.append(network.biased(slice(network.predicted, 2 * network.predicted), more))
    return tuple(fitted)


def _bits(symbols: NDArray[np.int32], scale: NDArray[np.int16], family: int) -> NDArray[np.float64]:
    table = np.clip(scale, 0, SCALES - 1) + SCALES * family
    bits: NDArray[np.float64] = frequency_tables().bits(symbols, table).sum(axis=0)
    return bits
