"""What tiles will come to: λ that solves for a bound, on tables whose solution is known."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.encoder.tile_work import EncodedTile
from sgicodec.rate_control.tile_rd_model import LMBDA_GRID, Bound, RdTable, TileRdModel, spread

LOOKS = [RdTable(tuple(c * g**-0.5 for g in LMBDA_GRID), tuple(c * g for g in LMBDA_GRID)) for c in (1.0, 2.0, 5.0)]


def tile(length: int, error: float, lmbda: float) -> EncodedTile:
    return EncodedTile(b"", {}, 1, error, 300, 1.0, length, lmbda)


def test_the_bound_is_met_at_lmbda() -> None:
    assert TileRdModel(LOOKS, "bytes").lmbda(Bound("bytes", 80.0), range(3)) == pytest.approx(0.01, rel=1e-4)
    assert TileRdModel(LOOKS, "error").lmbda(Bound("error", 0.08), range(3)) == pytest.approx(0.01, rel=1e-4)
    assert TileRdModel(LOOKS, "bytes").lmbda(Bound("bytes", 80.0), [2], done=30.0) == pytest.approx(0.01, rel=1e-4)


def test_limits() -> None:
    assert TileRdModel(LOOKS, "bytes").lmbda(Bound("bytes", 1e-3), range(3)) == pytest.approx(4.0, rel=1e-4)
    assert TileRdModel(LOOKS, "error").lmbda(Bound("error", 1e-30), range(3)) == pytest.approx(1e-6, rel=1e-4)


def test_what_was_found_corrects_the_rest() -> None:
    outlook, bound = TileRdModel(LOOKS, "bytes"), Bound("bytes", 160.0)
    outlook.learn(bound, {1: tile(40, 1.0, 0.01)}, 0.01)  # twice what was foretold
    assert outlook.foretold([0, 2], 0.01) == pytest.approx([20.0, 100.0])
    assert outlook.lmbda(bound, range(3)) == pytest.approx(0.01, rel=1e-3)
    outlook.learn(bound, {1: tile(0, 0.0, 0.01)}, 0.02)  # tells nothing
    assert outlook.foretold([0], 0.01) == pytest.approx([20.0])
    outlook.learn(bound, {1: tile(10, 1.0, 0.04)}, 0.04)  # what was foretold
    assert outlook.foretold([0], 0.02) == pytest.approx([2**0.5 * 50**0.5])


def test_more_tiles_at_one_lmbda_move_what_is_known_of_others() -> None:
    outlook, bound = TileRdModel(LOOKS, "bytes"), Bound("bytes", 160.0)
    outlook.learn(bound, {0: tile(5, 1.0, 0.04)}, 0.04)  # as foretold
    outlook.learn(bound, {0: tile(20, 1.0, 0.01)}, 0.01)  # twice that
    outlook.learn(bound, {0: tile(20, 1.0, 0.01), 2: tile(100, 1.0, 0.01), 1: tile(120, 1.0, 0.01)}, 0.01)  # 3 times
    assert outlook.foretold([0], 0.01) == pytest.approx([30.0])
    assert outlook.foretold([0], 0.04) == pytest.approx([7.5])


def test_need_is_positive_where_lmbda_has_to_rise() -> None:
    assert Bound("bytes", 100.0).need(200.0) == pytest.approx(1.0)
    assert Bound("error", 100.0).need(200.0) == pytest.approx(-1.0)


def test_samples_are_spread_over_what_weighs() -> None:
    assert spread(np.ones(9), 3) == [1, 4, 7]
    assert spread(np.array([0, 0, 9.0, 0, 0, 1.0]), 2) == [2]
    assert len(spread(np.zeros(40), 2)) == 2
    assert spread(np.ones(3), 9) == [0, 1, 2]
