"""In the course of a fit seeds leave where texture shows the picture for less, and stay where it would not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from half_texture import half_texture

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.device import Device
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile import stages
from sgicodec.encoder.tile.handover import HANDOVER, POSITION_BITS, Handover
from sgicodec.encoder.tile.sharing import MIN_WEIGHT
from sgicodec.encoder.tile.stages import encode, fit, prepare, share
from sgicodec.encoder.tile.state import Prepared, tile_of
from sgicodec.encoder.tile.texture_costs import TextureCosts
from sgicodec.encoder.tile.writing import write
from sgicodec.fit.trainer import Trainer
from sgicodec.picture import Picture

LMBDA, STEPS, EXACT_STEPS = 0.002, 200, 500
HEIGHT, WIDTH = 128, 256


def prepared(pixels: np.ndarray, channels: Any = "rgb", **settings: Any) -> Prepared:
    """Before anything is shared out."""
    picture = Picture(pixels, channels, (0.0, 255.0))
    every: dict[str, Any] = {"lmbda": LMBDA, "steps": EXACT_STEPS, "tune": "psnr"} | settings
    plan = stream_plan(Shape.of(picture), EncodeSettings(**every))
    return prepare(tile_of(picture, plan), LMBDA)


def fit_under_way(part: Prepared, weights: np.ndarray | None = None) -> Trainer:
    """A fit that knows what seeds show, and has not been told of texture."""
    tile, layout = part.tile, stages._first_layout(part)
    trainer = Trainer(
        tile.spec, part.fit, part.target, layout, tile.header.family, load_prior(tile.spec), weights=weights
    )
    for progress in trainer.iterate():
        if progress.step == STEPS:
            break
    return trainer


@pytest.fixture
def part() -> Prepared:
    return prepared(half_texture(HEIGHT, WIDTH))


def cost(part: Prepared, trainer: Trainer, kept: np.ndarray) -> float:
    """Squared error plus λ times bits of these seeds with texture."""
    gaussians = [part[kept] for part in trainer.seeds.gaussians()]
    residual = part.target - trainer.raster.forward(*gaussians, WIDTH, HEIGHT)
    texture = TextureCosts(residual, LMBDA).over(residual).sum()
    return float(texture + LMBDA * (trainer.gradient_step.seed_bits()[kept] + POSITION_BITS).sum())


def test_seeds_leave_cloth_and_stay_on_lines(part: Prepared) -> None:
    trainer = fit_under_way(part)
    x = trainer.seeds.layout.centre[:, 0]
    kept, shares = Handover(trainer, TextureCosts(part.target, LMBDA)).chosen()
    assert (x < 96).sum() > 50
    assert kept[x < 96].mean() < 0.1
    assert kept[x > 160].mean() > 0.8
    assert shares.shape == (4, 8)
    assert shares[:, :3].min() > 0.4
    assert cost(part, trainer, kept) < 0.95 * cost(part, trainer, np.ones_like(kept))


def test_errors_count_least_where_no_seed_is_left(part: Prepared) -> None:
    trainer = fit_under_way(part)
    before = len(trainer.seeds)
    Handover(trainer, TextureCosts(part.target, LMBDA)).run()
    assert len(trainer.seeds) < before
    assert trainer.weights is not None
    assert trainer.weights.min() == np.float32(MIN_WEIGHT)
    assert trainer.weights[:, :64].max() < 0.1
    assert trainer.weights[:, 192:].max() == 1.0
    assert [level.weights is None for level in trainer.levels] == [False] * len(trainer.levels)


def test_weights_stay_below_those_before(part: Prepared) -> None:
    given = np.random.default_rng(3).uniform(0.01, 2.0, (HEIGHT, WIDTH)).astype(np.float32)
    trainer = fit_under_way(part, given)
    Handover(trainer, TextureCosts(part.target, LMBDA)).run()
    assert trainer.weights is not None
    assert np.all(trainer.weights <= np.maximum(given, 0))
    assert np.all(trainer.weights >= np.minimum(given, MIN_WEIGHT))


def test_where_all_seeds_pay_nothing_changes() -> None:
    y, x = np.mgrid[:64, :96]
    edge = np.where(x + 0.3 * y > 60, 200, 60).astype(np.uint8)
    part = prepared(np.repeat(edge[..., None], 3, axis=2))
    trainer = fit_under_way(part)
    weights, layout = trainer.weights, trainer.seeds.layout
    Handover(trainer, TextureCosts(part.target, LMBDA)).run()
    assert trainer.weights is weights
    assert trainer.seeds.layout is layout


@pytest.mark.parametrize("channels", ["gray", "rgba"])
def test_one_seed_stays_over_noise(channels: str) -> None:
    noise = np.random.default_rng(4).integers(0, 256, (64, 64, 1 if channels == "gray" else 4)).astype(np.uint8)
    part = prepared(noise, channels)
    trainer = fit_under_way(part)
    Handover(trainer, TextureCosts(part.target, LMBDA)).run()
    assert len(trainer.seeds) >= 1


def test_an_encode_hands_over_once_and_searches_by_the_same_weights(monkeypatch: pytest.MonkeyPatch) -> None:
    part, seen = prepared(half_texture(64, 128)), []
    run = Handover.run

    def spy(self: Handover) -> None:
        seen.append(self.trainer.schedule.done)
        run(self)

    monkeypatch.setattr(Handover, "run", spy)
    state = fit(share(part))
    assert seen == [pytest.approx(HANDOVER, abs=0.01)]
    assert state.weights is not None
    assert state.weights[:, :32].max() < 0.1
    assert (state.model.layout.centre[:, 0] < 48).mean() < 0.2


@pytest.mark.parametrize("settings", [{"texture": False}, {"steps": EXACT_STEPS // 10}])
def test_who_does_not_hand_over(settings: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Handover, "run", lambda self: pytest.fail("handed over"))
    part = prepared(half_texture(32, 64), rdoq=False, **settings)
    assert write(encode(part.tile)).payload


def test_the_stream_does_not_depend_on_what_runs_beside_the_fit() -> None:
    tile = prepared(half_texture(64, 96)).tile
    one, two = (write(encode(tile_of(tile.picture, tile.plan, Device(threads)))).payload for threads in (1, 2))
    assert one == two
