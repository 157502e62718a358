"""What a tile is foretold to cost: by its detail, from a part of its pixels."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, Picture, read
from sgicodec.encoder.plan import Plan, Shape, stream_plan
from sgicodec.encoder.tile.inputs import tile_of
from sgicodec.encoder.tile.stages import prepare
from sgicodec.encoder.tiles.weight import sampled, tile_weight
from sgicodec.model.layout import adaptive_layout
from sgicodec.picture import Metadata

DATA = Path(__file__).parents[3] / "data"
GEO_WITH_NODATA_0 = bytes.fromhex("49492a00 08000000 0100 81a40200 02000000 30000000 00000000")


def crop(name: str, width: int = 704, height: int = 448) -> Picture:
    picture = read(DATA / name)
    return replace(picture, pixels=np.ascontiguousarray(picture.pixels[64 : 64 + height, 64 : 64 + width]))


def plan_for(picture: Picture, **choices: object) -> Plan:
    return stream_plan(Shape.of(picture), EncodeSettings(**choices))  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["kodim23.png", "kodim13.png"])
def test_a_sixteenth_tells_of_the_whole(name: str) -> None:
    """The seeds that a fit really starts with, at the price that the weight has for them."""
    picture = crop(name)
    plan = plan_for(picture)
    tile = tile_of(picture, plan)
    prepared = prepare(tile, tile.fit.lmbda)
    price = prepared.fit.split * prepared.fit.lmbda * prepared.fit.seed_bits
    seeds = len(adaptive_layout(prepared.target, price, weights=tile.reference.weights))
    assert tile_weight(picture, plan) == pytest.approx(704 * 448 + 31 * seeds, rel=0.35)


def test_detail_and_a_smaller_lmbda_weigh_more() -> None:
    smooth, busy = crop("kodim23.png"), crop("kodim13.png")
    plain = {"tune": "psnr", "texture": False}
    assert tile_weight(busy, plan_for(busy, **plain)) > 1.3 * tile_weight(smooth, plan_for(smooth, **plain))
    assert tile_weight(busy, plan_for(busy, quality=70)) > 1.3 * tile_weight(busy, plan_for(busy))
    flat = replace(smooth, pixels=np.full_like(smooth.pixels, 99))
    assert 704 * 448 <= tile_weight(flat, plan_for(flat)) < 1.1 * 704 * 448


def test_blank_tiles_weigh_next_to_nothing() -> None:
    picture = replace(crop("kodim23.png"), metadata=Metadata(geo=GEO_WITH_NODATA_0))
    picture = replace(picture, pixels=np.maximum(picture.pixels, 1))
    plan = plan_for(picture)
    assert plan.header.masked == "nodata"
    assert tile_weight(replace(picture, pixels=np.zeros_like(picture.pixels)), plan) == 1.0
    assert tile_weight(picture, plan) > 704 * 448


def test_the_paper_profile_weighs_pixels() -> None:
    picture = crop("kodim13.png")
    assert tile_weight(picture, plan_for(picture, profile="paper")) == 704 * 448


def test_what_is_sampled() -> None:
    picture = crop("kodim13.png")
    blocks = picture.pixels.reshape(8, 56, 8, 88, 3)
    for part, (row, column) in zip(sampled(picture), ((2, 2), (2, 5), (5, 2), (5, 5)), strict=True):
        np.testing.assert_array_equal(part.pixels, blocks[row, :, column])
    small = crop("kodim13.png", 255, 256)
    assert sampled(small) == [small]
