"""Small integer arrays of a tile: network weights, the base layer, the signs of the hash grid.

Shapes come from the header. What the encoder chose (tables, predictors, probabilities) precedes the array as raw bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import (
    TABLES,
    bernoulli_frequencies,
    bits_of_frequencies,
    frequency_tables,
)
from sgicodec.errors import UsageError

__all__ = ["BaseChannel", "base_channels", "base_references", "write_base", "write_signs", "write_weights"]

_TABLE_BITS = (TABLES - 1).bit_length()

Plane = NDArray[np.int64]


def write_weights(writer: SymbolWriter, weights: ArrayLike, shape: tuple[int, ...]) -> None:
    """One tensor of integers under the one zero-centred table that suits it best."""
    values = _shaped(weights, shape)
    table = frequency_tables().best(values)
    writer.code_int(table, _TABLE_BITS)
    writer.code(values, np.full(shape, table, np.int16))


def write_signs(writer: SymbolWriter, bits: ArrayLike, counts: Sequence[int]) -> None:
    """Σ counts values 0 or 1, level after level, each level with its own probability of a 1 in eight bits."""
    level = np.repeat(np.arange(len(counts)), counts)
    values = _shaped(bits, (level.size,))
    if np.any((values < 0) | (values > 1)):
        raise UsageError("signs: values must be 0 or 1")
    occurrences = np.bincount(2 * level + values, minlength=2 * len(counts)).reshape(-1, 2)  # [L, 2]
    codes = np.argmin(occurrences @ bits_of_frequencies(bernoulli_frequencies(np.arange(256))).T, axis=1)
    writer.code_bits(codes, 8)
    writer.code_categorical(values, bernoulli_frequencies(codes), level)


@dataclass(frozen=True)
class BaseChannel:
    """How a channel of the base layer is coded: number of its predictor, weights in eighths of the errors of channels 0
    and the one before, and the table of what remains.
    """

    predictor: int
    weights: list[int]
    table: int
    error: Plane
    rest: Plane


def base_channels(planes: NDArray[np.int64]) -> list[BaseChannel]:
    """The cheapest coding of planes [C, h, w], found channel by channel."""
    channels: list[BaseChannel] = []
    for channel, plane in enumerate(planes):
        references = [channels[i].error for i in base_references(channel)]
        number, error = _best_prediction(plane)
        weights = _fit_weights(error, references)
        rest = error - _mixed(references, weights, error.shape)
        channels.append(BaseChannel(number, weights, frequency_tables().best(rest), error, rest))
    return channels


def base_references(channel: int) -> list[int]:
    """Channels whose errors predict those of `channel`."""
    return [i for i in sorted({0, channel - 1}) if 0 <= i < channel]


def write_base(writer: SymbolWriter, base: ArrayLike, shape: tuple[int, int, int]) -> None:
    """Planes [C, h, w] of a smooth picture in integer steps; luma first.

    A value is predicted from its left, upper and upper left neighbours by one of PREDICTORS; the prediction
    error is in turn predicted from the errors of channel 0 and of the channel before, with weights in
    eighths. What remains has one table per channel.
    """
    for channel in base_channels(_shaped(base, shape)):
        writer.code_int(channel.predictor, 2)
        writer.code_bits(np.add(channel.weights, 8), 4)
        writer.code_int(channel.table, _TABLE_BITS)
        writer.code(channel.rest, np.full(shape[1:], channel.table, np.int16))


def _west(west: Plane, north: Plane, northwest: Plane) -> Plane:
    return west


def _north(west: Plane, north: Plane, northwest: Plane) -> Plane:
    return north


def _mean(west: Plane, north: Plane, northwest: Plane) -> Plane:
    return (west + north) >> 1


def _blend(west: Plane, north: Plane, northwest: Plane) -> Plane:
    """Between `_mean`, best for noise, and LOCO-I's median edge detector, W + N − NW clamped to W … N."""
    median = np.clip(west + north - northwest, np.minimum(west, north), np.maximum(west, north))
    blend: Plane = (2 * median + west + north + 2) >> 2
    return blend


PREDICTORS = (_west, _north, _mean, _blend)


def _best_prediction(plane: Plane) -> tuple[int, Plane]:
    """Number of the predictor whose errors cost least, and these errors."""
    padded = np.zeros((plane.shape[0] + 1, plane.shape[1] + 1), np.int64)
    padded[1:, 1:] = plane
    padded[0, 2:] = plane[0, :-1]  # at an edge the one neighbour there is stands for all three
    padded[2:, 0] = plane[:-1, 0]
    errors = [plane - predict(padded[1:, :-1], padded[:-1, 1:], padded[:-1, :-1]) for predict in PREDICTORS]
    number = int(np.argmin(frequency_tables().least_bits(np.stack(errors))))
    return number, errors[number]


def _fit_weights(error: Plane, references: list[Plane]) -> list[int]:
    """Weights −8 … 7 of least cost, by two rounds of coordinate descent: the references are correlated."""
    weights = [0] * len(references)
    for i in [*range(len(references))] * 2:
        options = [[*weights[:i], weight, *weights[i + 1 :]] for weight in range(-8, 8)]
        rests = np.stack([error - _mixed(references, option, error.shape) for option in options])
        weights = options[int(np.argmin(frequency_tables().least_bits(rests)))]
    return weights


def _mixed(references: list[Plane], weights: list[int], shape: tuple[int, ...]) -> Plane:
    """Σ weight · reference in eighths, rounded half up."""
    total = np.full(shape, 4, np.int64)
    for reference, weight in zip(references, weights, strict=True):
        total += weight * reference
    return total >> 3


def _shaped(values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.int64]:
    array = np.asarray(values, np.int64)
    if array.shape != shape:
        raise UsageError(f"array of shape {array.shape} where the header says {shape}")
    return array
