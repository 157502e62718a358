"""R-D model of tiles: λ that solves for a sum, on tables whose solution is known."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.rate_control.tile_rd_model import LMBDA_GRID, RdTable, TileRdModel, is_far, spread_over

TABLES = [RdTable(tuple(c * g**-0.5 for g in LMBDA_GRID), tuple(c * g for g in LMBDA_GRID)) for c in (1.0, 2.0, 5.0)]


def test_what_is_wanted_is_predicted_at_lmbda() -> None:
    assert TileRdModel(TABLES, "bytes").lmbda(80.0) == pytest.approx(0.01, rel=1e-4)
    assert TileRdModel(TABLES, "error").lmbda(0.08) == pytest.approx(0.01, rel=1e-4)


def test_limits() -> None:
    assert TileRdModel(TABLES, "bytes").lmbda(1e-3) == pytest.approx(4.0, rel=1e-4)
    assert TileRdModel(TABLES, "error").lmbda(1e-30) == pytest.approx(1e-6, rel=1e-4)


def test_what_was_found_corrects_the_rest() -> None:
    model = TileRdModel(TABLES, "bytes")
    model.learn([1], 0.01, 40.0)  # twice what was predicted
    assert model.predict(0.01) == pytest.approx([20.0, 40.0, 100.0])
    assert model.lmbda(160.0) == pytest.approx(0.01, rel=1e-3)
    model.learn([1], 0.02, 0.0)  # tells nothing
    assert model.predict(0.01)[0] == pytest.approx(20.0)
    model.learn([1], 0.04, 10.0)  # what was predicted
    assert model.predict(0.02)[0] == pytest.approx(2**0.5 * 50**0.5)


def test_samples_are_spread_over_the_weights() -> None:
    assert spread_over(np.ones(9), 3) == [1, 4, 7]
    assert spread_over(np.array([0, 0, 9.0, 0, 0, 1.0]), 2) == [2]
    assert len(spread_over(np.zeros(40), 2)) == 2
    assert spread_over(np.ones(3), 9) == [0, 1, 2]


def test_lmbda_stay_within_half_an_octave() -> None:
    assert [is_far(0.01, at) for at in (0.0071, 0.0070, 0.0141, 0.0142)] == [False, True, False, True]
