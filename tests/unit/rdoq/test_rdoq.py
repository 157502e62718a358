"""The search as a whole: it never costs, it follows λ, and streams show what it promised."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.decoder.stream import open_stream
from sgicodec.picture import to_unit
from sgicodec.rdoq import Objective, Rdoq, RdoqResult, RdoqSettings
from sgicodec.rdoq.objective import joined

Stage = Callable[..., tuple[Objective, TileModel]]

PICTURE = Path(__file__).parents[2] / "data" / "kodim23.png"


def refined(objective: Objective, model: TileModel, lmbda: float, settings: RdoqSettings) -> RdoqResult:
    return Rdoq(objective.header, model, objective.picture, lmbda, settings, objective.device).best()


@pytest.mark.parametrize("lmbda", [1e-4, 1e-3, 1e-2])
def test_it_gains(stage: Stage, lmbda: float) -> None:
    objective, model = stage()
    found = refined(objective, model, lmbda, RdoqSettings(passes=2))
    assert found.cost == objective.cost(found.model)
    assert found.cost.at(lmbda) < 0.9 * objective.cost(model).at(lmbda)


def test_more_passes_never_cost(stage: Stage) -> None:
    objective, model = stage()
    search = Rdoq(objective.header, model, objective.picture, 1e-3, device=objective.device)
    costs = [search.best(passes).cost.at(1e-3) for passes in range(5)]
    assert costs[0] == objective.cost(model).at(1e-3)
    assert costs == sorted(costs, reverse=True)


def test_one_pass_is_the_same_without_a_look(stage: Stage) -> None:
    objective, model = stage()
    search = Rdoq(objective.header, model, objective.picture, 1e-3, device=objective.device)
    expected = search.best(passes=1)
    np.testing.assert_array_equal(joined(search.once()), joined(expected.model))


def test_what_would_cost_is_not_taken(stage: Stage) -> None:
    """Steps four octaves too coarse spoil any model."""
    objective, model = stage()
    good = refined(objective, model, 1e-5, RdoqSettings(passes=3))
    spoilt = RdoqSettings(passes=1, coarser=4.0)
    kept = refined(objective, good.model, 1e-5, spoilt)
    assert kept.cost == good.cost
    np.testing.assert_array_equal(joined(kept.model), joined(good.model))


def test_size_follows_the_price_of_bits(stage: Stage) -> None:
    objective, model = stage()
    fitted = refined(objective, model, 1e-4, RdoqSettings(passes=4)).model
    settings = RdoqSettings(passes=2, coarser=0.0)
    bits = [refined(objective, fitted, 1e-4 * factor, settings).cost.bits for factor in (1, 8, 64, 512)]
    assert bits == sorted(bits, reverse=True)
    assert bits[-1] < 0.8 * bits[0]


def test_same_model_for_any_number_of_threads(stage: Stage) -> None:
    models = []
    for threads in (1, 2):
        objective, model = stage(height=120, width=130, threads=threads)
        models.append(refined(objective, model, 1e-3, RdoqSettings(passes=3)).model)
    np.testing.assert_array_equal(joined(models[0]), joined(models[1]))
    np.testing.assert_array_equal(models[0].layout.corner, models[1].layout.corner)


def test_streams_cost_less() -> None:
    """Of a fitted photograph, from what is on disk and what is decoded: J falls by more than two in a hundred."""
    whole = read(PICTURE)
    picture = replace(whole, pixels=np.ascontiguousarray(whole.pixels[128:256, 100:292]))
    unit, lmbda = to_unit(picture), 0.004
    costs = []
    for searched in (False, True):
        data = encode_picture(
            picture, EncodeSettings(lmbda=lmbda, steps=150, rdoq=searched, tune="psnr", texture=False)
        ).data
        error = np.sum((open_stream(data).render().astype(np.float64) - unit) ** 2)
        costs.append(error + lmbda * 8 * len(data))
    assert costs[1] < 0.98 * costs[0]


def test_passes_end_where_the_caller_says(stage: Stage) -> None:
    objective, model = stage()
    search = Rdoq(objective.header, model, objective.picture, 1e-3, device=objective.device)
    none = search.best(ending=lambda: True)
    assert search.passes == 0
    assert none.cost == objective.cost(model)
    two = search.best(ending=lambda: search.passes == 2)
    assert search.passes == 2
    assert two.cost == search.best(passes=2).cost
