"""Seeds that are dropped and added: what they hold, and what Adam knows of them, stays with them."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.device import ONE_THREAD
from sgicodec.fit.adam import Adam
from sgicodec.fit.seed_set import SeedSet
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

LAYOUT = SeedLayout(np.array([[0, 0], [8, 0], [0, 8], [8, 8]], np.int32), np.array([3, 3, 3, 2], np.int8))
MORE = SeedLayout(np.array([[12, 8], [12, 12]], np.int32), np.array([2, 1], np.int8))
TARGET = np.random.default_rng(5).normal(0.0, 0.3, (3, 16, 16)).astype(np.float32)
specs = pytest.mark.parametrize("spec", [default_spec(3), paper_spec(3, per_seed=2)])


def moved(seeds: SeedSet, adam: Adam, gradients: dict[str, np.ndarray]) -> None:
    for name, value in seeds.values.items():
        adam.move(name, value, gradients[name], 0.3)


def seed_set(spec: ModelSpec) -> tuple[SeedSet, Adam]:
    """Four seeds, moved apart by a step."""
    seeds = SeedSet(spec, LAYOUT, TARGET, np.random.default_rng(2), ONE_THREAD)
    adam, rng = Adam((0.9, 0.99), 1e-12, ONE_THREAD), np.random.default_rng(3)
    moved(seeds, adam, {name: rng.normal(size=v.shape).astype(np.float32) for name, v in seeds.values.items()})
    return seeds, adam


@specs
def test_rows_stay_with_their_seeds(spec: ModelSpec) -> None:
    """A step without gradient moves old rows by their moments, which must have come along, and new ones not at all."""
    seeds, adam = seed_set(spec)
    untouched, same_adam = seed_set(spec)
    kept = np.array([True, False, True, True])
    seeds.keep(kept, adam)
    seeds.add(MORE, np.full((2, 3), 0.25, np.float32), adam)
    assert len(seeds) == 5
    np.testing.assert_array_equal(seeds.layout.corner, np.concatenate([LAYOUT.corner[kept], MORE.corner]))
    np.testing.assert_array_equal(seeds.layout.log_size, [3, 3, 2, 2, 1])
    fresh = {name: value[3:].copy() for name, value in seeds.values.items()}
    assert fresh["colour" if spec.plain else "scales"].any()
    before = untouched.values["offset"].copy()
    moved(seeds, adam, {name: np.zeros_like(value) for name, value in seeds.values.items()})
    moved(untouched, same_adam, {name: np.zeros_like(value) for name, value in untouched.values.items()})
    assert (untouched.values["offset"] != before).all()
    for name, value in seeds.values.items():
        np.testing.assert_array_equal(value[:3], untouched.values[name][kept])
        np.testing.assert_array_equal(value[3:], fresh[name])
