"""R-D model of tiles: λ that solves for a bound, on tables whose solution is known."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.rate_control.allocation import Option
from sgicodec.rate_control.target import RateTarget
from sgicodec.rate_control.tile_rd_model import LMBDA_GRID, Bound, RdTable, TileRdModel

TABLES = [RdTable(tuple(c * g**-0.5 for g in LMBDA_GRID), tuple(c * g for g in LMBDA_GRID)) for c in (1.0, 2.0, 5.0)]


def tile(length: int, error: float, lmbda: float) -> EncodedTile:
    return EncodedTile(b"", {}, 1, error, 0.5 * error, 300, 1.0, length, lmbda)


def test_the_bound_is_met_at_lmbda() -> None:
    assert TileRdModel(TABLES, "bytes").lmbda(Bound("bytes", 80.0), range(3)) == pytest.approx(0.01, rel=1e-4)
    assert TileRdModel(TABLES, "error").lmbda(Bound("error", 0.08), range(3)) == pytest.approx(0.01, rel=1e-4)
    assert TileRdModel(TABLES, "bytes").lmbda(Bound("bytes", 80.0), [2], done=30.0) == pytest.approx(0.01, rel=1e-4)


def test_limits() -> None:
    assert TileRdModel(TABLES, "bytes").lmbda(Bound("bytes", 1e-3), range(3)) == pytest.approx(4.0, rel=1e-4)
    assert TileRdModel(TABLES, "error").lmbda(Bound("error", 1e-30), range(3)) == pytest.approx(1e-6, rel=1e-4)


def test_what_was_found_corrects_the_rest() -> None:
    model, bound = TileRdModel(TABLES, "bytes"), Bound("bytes", 160.0)
    model.learn(bound, {1: tile(40, 1.0, 0.01)}, 0.01)  # twice what was predicted
    assert model.predict([0, 2], 0.01) == pytest.approx([20.0, 100.0])
    assert model.lmbda(bound, range(3)) == pytest.approx(0.01, rel=1e-3)
    model.learn(bound, {1: tile(0, 0.0, 0.01)}, 0.02)  # tells nothing
    assert model.predict([0], 0.01) == pytest.approx([20.0])
    model.learn(bound, {1: tile(10, 1.0, 0.04)}, 0.04)  # what was predicted
    assert model.predict([0], 0.02) == pytest.approx([2**0.5 * 50**0.5])


def test_more_tiles_at_one_lmbda_move_what_is_known_of_others() -> None:
    model, bound = TileRdModel(TABLES, "bytes"), Bound("bytes", 160.0)
    model.learn(bound, {0: tile(5, 1.0, 0.04)}, 0.04)  # as predicted
    model.learn(bound, {0: tile(20, 1.0, 0.01)}, 0.01)  # twice that
    model.learn(bound, {0: tile(20, 1.0, 0.01), 2: tile(100, 1.0, 0.01), 1: tile(120, 1.0, 0.01)}, 0.01)  # 3 times
    assert model.predict([0], 0.01) == pytest.approx([30.0])
    assert model.predict([0], 0.04) == pytest.approx([7.5])


def test_error_is_positive_where_lmbda_has_to_rise() -> None:
    assert Bound("bytes", 100.0).error(200.0) == pytest.approx(1.0)
    assert Bound("error", 100.0).error(200.0) == pytest.approx(-1.0)


def test_a_target_leaves_a_bound_to_the_tiles() -> None:
    size = Bound.of_target(RateTarget(bytes=1000.0), 300, 9999, 0.9)
    assert (size, size.aim.value, size.limit) == (Bound("bytes", 700.0), pytest.approx(0.985 * 700), 700)
    assert Bound.of_target(RateTarget(bytes=10.0), 300, 9999, 0.9).value == 1.0
    error = Bound.of_target(RateTarget(psnr=20.0), 300, 5000, 0.5)
    assert (error.what, error.value) == ("error", pytest.approx(100.0))
    assert -10 * np.log10(error.limit / error.value) == pytest.approx(-0.03)
    assert error.aim.value < error.value


def test_options_and_parts_of_a_tile() -> None:
    coded = tile(40, 3.0, 0.01)
    assert (Bound("bytes", 1.0).of(coded), Bound("error", 1.0).of(coded)) == (40, 3.0)
    assert Bound("bytes", 1.0).option(coded) == Option(40, 1.5)
    assert Bound("error", 1.0).option(coded) == Option(3.0, 40)
