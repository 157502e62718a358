"""Contrasts by a score: finer steps where errors cost more for each symbol, elsewhere none, no farther than asked."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec.encoder.tile.score_contrast import better_contrasts
from sgicodec.model.texture_symbols import CONTRAST_LIMIT, TextureSteps, TextureSymbols

ROWS, COLUMNS = 6, 8
USUAL = np.zeros((ROWS, COLUMNS), np.int8)


def symbols_of(count: NDArray[np.int64]) -> TextureSymbols:
    """A layer with so many symbols that are not 0 in each root, a third of them of each channel."""
    symbols = np.zeros((3, 32 * ROWS, 32 * COLUMNS), np.int16)
    for (row, column), number in np.ndenumerate(count):
        root = np.zeros(3 * 32 * 32, np.int16)
        root[:number] = np.where(np.arange(number) % 2, -3, 1)
        at = slice(32 * row, 32 * row + 32), slice(32 * column, 32 * column + 32)
        symbols[:, at[0], at[1]] = root.reshape(32, 32, 3).transpose(2, 0, 1)
    log_size = np.full((4 * ROWS, 4 * COLUMNS), 5, np.uint8)
    return TextureSymbols((32 * COLUMNS, 32 * ROWS), TextureSteps(400), log_size, USUAL, symbols)


def pixels_of(loss: NDArray[np.float64], height: int = 32 * ROWS, width: int = 32 * COLUMNS) -> NDArray[np.float32]:
    """Gains of pixels that add up to so much in each root."""
    pixels = np.repeat(np.repeat(loss / 1024, 32, axis=0), 32, axis=1)
    return pixels[:height, :width].astype(np.float32)


def test_where_errors_cost_more_for_each_symbol_steps_become_finer() -> None:
    loss = np.full((ROWS, COLUMNS), 1.0)
    loss[:, :4] = 16.0
    found = better_contrasts(USUAL, USUAL, pixels_of(loss), symbols_of(np.full((ROWS, COLUMNS), 300)))
    # steps are two octaves apart from equal losses, one on each side; a quarter of it is a quarter of an octave
    assert (found[:, :3] == -1).all()
    assert (found[:, 5:] == 1).all()


def test_equal_losses_for_symbols_leave_contrasts_as_they_are() -> None:
    count = np.random.default_rng(1).integers(200, 210, (ROWS, COLUMNS))
    contrast = np.random.default_rng(2).integers(-3, 4, (ROWS, COLUMNS)).astype(np.int8)
    found = better_contrasts(contrast, contrast, pixels_of((count + 40) * 0.01), symbols_of(count))
    np.testing.assert_array_equal(found, contrast)


def test_roots_of_few_symbols_tell_nothing_and_stay() -> None:
    count = np.full((ROWS, COLUMNS), 400)
    count[:, 4:] = 20
    loss = np.random.default_rng(3).uniform(0.1, 40, (ROWS, COLUMNS))
    found = better_contrasts(USUAL, USUAL, pixels_of(loss), symbols_of(count))
    assert found[:, :3].any()
    assert not found[:, 5:].any()

    nothing = np.zeros((ROWS, COLUMNS), np.int64)
    np.testing.assert_array_equal(better_contrasts(USUAL, USUAL, pixels_of(loss), symbols_of(nothing)), USUAL)


@pytest.mark.parametrize("level", [-CONTRAST_LIMIT, 0, CONTRAST_LIMIT])
def test_contrasts_stay_near_those_of_the_tuning_and_within_the_format(level: int) -> None:
    loss = np.full((ROWS, COLUMNS), 1e-3)
    loss[:, :4] = 1e3
    contrast = usual = np.full((ROWS, COLUMNS), level, np.int8)
    for _ in range(20):
        contrast = better_contrasts(contrast, usual, pixels_of(loss), symbols_of(np.full((ROWS, COLUMNS), 300)))
    assert contrast.dtype == np.int8
    assert contrast[0, 0] == max(level - 4, -CONTRAST_LIMIT)
    assert level < contrast[0, 7] <= level + 4 or contrast[0, 7] == CONTRAST_LIMIT


def test_scores_that_fall_without_errors_say_nothing() -> None:
    count = symbols_of(np.full((ROWS, COLUMNS), 300))
    for loss in (np.zeros((ROWS, COLUMNS)), np.full((ROWS, COLUMNS), -1.0)):
        np.testing.assert_array_equal(better_contrasts(USUAL, USUAL, pixels_of(loss), count), USUAL)


def test_roots_reach_beyond_the_picture() -> None:
    loss = np.full((ROWS, COLUMNS), 5.0)
    gain = pixels_of(loss, 32 * ROWS - 11, 32 * COLUMNS - 30)
    found = better_contrasts(USUAL, USUAL, gain, symbols_of(np.full((ROWS, COLUMNS), 300)))
    # of the last column two pixels in 32 are there, and lose as little; of the last row 21
    assert (found[:, -1] > found[:, 0]).all()
    assert not found[:-1, :-2].any()
