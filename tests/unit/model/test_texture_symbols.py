"""Texture in integers: what its fields stand for, by the formulas of docs/format.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from texture_reader import AFTER
from textures import random_symbols

from sgicodec.model.texture_symbols import SAME_COLOURS, TextureSteps


def test_steps_by_their_formulas() -> None:
    steps = TextureSteps(300, (0, 16, 31), (3, 15), (0, 9, 15))
    first = 2 ** ((300 - 480) / 32)
    np.testing.assert_allclose(
        steps.of_channels, [first, first * 2 ** (-16 / 8), first, first * 2 ** (15 / 8)], rtol=1e-6
    )
    assert steps.growth == (1.5, 7.5)
    assert steps.added == (-0.25, 1 / 32, 7 / 32)


def odd_quantisers(q: np.ndarray) -> np.ndarray:
    """Which symbols of a block [n, n] are of the odd quantiser."""
    side, state, odd = len(q), 0, np.zeros(q.shape, bool)
    for diagonal in range(2 * side - 1):
        for u in range(max(0, diagonal - side + 1), min(diagonal, side - 1) + 1):
            odd[diagonal - u, u] = state % 2
            state = AFTER[state][q[diagonal - u, u] % 2]
    return odd


def in_opponent_colours(cell: np.ndarray, colours: tuple[int, int, int]) -> np.ndarray:
    """Amplitudes [C, n, n] of a layer that is coded in these colours."""
    if len(cell) < 3:
        return cell
    angle = np.pi * (colours[2] - 8) / 32
    one, two = (share * cell[0] for share in ((colours[0] - 32) / 64, (colours[1] - 32) / 64))
    one, two = (
        one + np.cos(angle) * cell[1] - np.sin(angle) * cell[2],
        two + np.sin(angle) * cell[1] + np.cos(angle) * cell[2],
    )
    return np.stack([cell[0], one, two, *cell[3:]])


@pytest.mark.parametrize(
    ("channels", "size", "seed", "colours"),
    [
        (1, (40, 70), 1, SAME_COLOURS),
        (3, (90, 33), 2, SAME_COLOURS),
        (3, (90, 33), 2, (0, 63, 0)),
        (4, (64, 64), 3, (40, 29, 15)),
    ],
)
def test_amplitudes_by_their_formula(
    channels: int, size: tuple[int, int], seed: int, colours: tuple[int, int, int]
) -> None:
    symbols = random_symbols(channels, *size, seed)
    symbols = replace(symbols, steps=replace(symbols.steps, colours=colours))
    layer, steps = symbols.layer(), symbols.steps
    assert (layer.size, layer.channels) == (size, channels)
    counts, at = {8: 0, 16: 0, 32: 0}, 0
    for (x, y), log in zip(layer.corner.tolist(), layer.log_size.tolist(), strict=True):
        side = 1 << log
        counts[side] += 1
        assert symbols.log_size[y // 8, x // 8] == log
        share = (np.arange(side) + 0.5) / side
        squared = np.add.outer(share**2, share**2) / 2
        coded = []
        for channel in range(channels):
            q = symbols.symbols[channel, y : y + side, x : x + side].astype(np.float64)
            excess = np.choose(np.minimum(np.abs(q), 3).astype(int), [0, *((np.array(steps.excess) - 8) / 32)])
            ratio = (0, *(ratio - 16 for ratio in steps.ratios))[channel]
            step = 2 ** ((steps.step - 480) / 32 + ratio / 8 + symbols.contrast[y // 32, x // 32] / 4)
            slope = steps.slopes[channel > 0] / 2
            half = 0.5 * odd_quantisers(q.astype(int))
            coded.append(np.sign(q) * (np.abs(q) - half + excess) * step * (1 + slope * squared))
        expected = in_opponent_colours(np.array(coded), colours)
        found = layer.amplitudes[at : at + expected.size].reshape(expected.shape)
        np.testing.assert_allclose(found, expected, rtol=2e-6, atol=2e-7 * np.abs(expected).max())
        at += expected.size
    assert at == len(layer.amplitudes)
    assert counts == symbols.counts
    assert not symbols.is_empty
    # In coding order: Z-order within roots, these row by row.
    keys = [
        (y // 32, x // 32, sum((x >> b & 1) << 2 * b | (y >> b & 1) << 2 * b + 1 for b in range(5)))
        for x, y in layer.corner.tolist()
    ]
    assert keys == sorted(keys)
