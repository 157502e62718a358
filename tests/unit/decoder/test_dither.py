"""Dither: means are kept, exact samples stay, and the pattern knows no bands."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.decoder.dither import dithered
from sgicodec.raster import Mapping

U8 = np.dtype(np.uint8)


def bytes_of(channels: int) -> Mapping:
    return Mapping(np.zeros(channels, np.float32), np.full(channels, 255, np.float32))


@pytest.mark.parametrize("level", [0.0, 0.1, 17.25, 100.5, 254.9, 255.0])
def test_the_mean_is_the_value(level: float) -> None:
    found = dithered(np.full((64, 64, 3), level / 255, np.float32), bytes_of(3), (5, 9), None, U8)
    assert set(np.unique(found).tolist()) <= {int(level), int(np.ceil(level))}
    blocks = found.astype(np.float64).reshape(4, 16, 4, 16, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(blocks, level, atol=0.06)


def test_samples_that_are_exact_stay() -> None:
    values = np.arange(256, dtype=np.float32).reshape(16, 16, 1) / 255
    found = dithered(values, bytes_of(1), (0, 0), None, U8)
    np.testing.assert_array_equal(found[..., 0], np.arange(256).reshape(16, 16))


def test_out_of_range() -> None:
    values = np.array([[[-3.0], [7.0]]], np.float32)
    assert dithered(values, bytes_of(1), (0, 0), None, U8).ravel().tolist() == [0, 255]


def test_a_part_has_the_pattern_of_the_whole() -> None:
    values = np.random.default_rng(1).random((20, 30, 4), np.float32)
    whole = dithered(values, bytes_of(4), (0, 0), 3, U8)
    np.testing.assert_array_equal(dithered(values[7:, 11:], bytes_of(4), (11, 7), 3, U8), whole[7:, 11:])


def test_alpha_is_rounded_and_channels_do_not_rise_together() -> None:
    found = dithered(np.full((64, 64, 4), 100.5 / 255 - 1e-4, np.float32), bytes_of(4), (0, 0), 3, U8)
    assert (found[..., 3] == 100).all()
    rises = (found[..., :3] == 101).reshape(-1, 3).T
    assert np.abs(np.corrcoef(rises)[np.triu_indices(3, 1)]).max() < 0.6
