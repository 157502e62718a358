"""Seeds that are dropped and added: what they hold, and what Adam knows of them, stays with them."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from sgicodec.fit.adam import Adam, Group
from sgicodec.fit.seed_set import Population
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec, default_spec, paper_spec

LAYOUT = SeedLayout(np.array([[0, 0], [8, 0], [0, 8], [8, 8]], np.int32), np.array([3, 3, 3, 2], np.int8))
MORE = SeedLayout(np.array([[12, 8], [12, 12]], np.int32), np.array([2, 1], np.int8))
TARGET = np.random.default_rng(5).normal(0.0, 0.3, (3, 16, 16)).astype(np.float32)
specs = pytest.mark.parametrize("spec", [default_spec(3), default_spec(3, per_seed=2), paper_spec(3, per_seed=2)])


def population(spec: ModelSpec) -> tuple[Population, Adam]:
    """Four seeds, moved apart by a step."""
    seeds = Population(spec, LAYOUT, TARGET, torch.Generator().manual_seed(2))
    adam = Adam([Group(name, [value], 0.3) for name, value in seeds.values.items()], (0.9, 0.99), 1e-12)
    noise = torch.Generator().manual_seed(3)
    for value in seeds.values.values():
        value.grad = torch.randn(value.shape, generator=noise)
    adam.step()
    return seeds, adam


@specs
def test_energy_is_the_sum_of_squares_of_what_each_gaussian_draws(spec: ModelSpec) -> None:
    seeds, _ = population(spec)
    with torch.no_grad():
        means, covariances, colours = (part.double().numpy() for part in seeds.gaussians(seeds.attributes()))
    spacing = 0.5
    axis = np.arange(-250.0, 266.0, spacing)
    y, x = np.meshgrid(axis, axis, indexing="ij")
    for number, energy in enumerate(seeds.energy().tolist()):
        total = 0.0
        for g in range(number * spec.per_seed, (number + 1) * spec.per_seed):
            a, b, c = covariances[g]
            u, v = x - means[g, 0], y - means[g, 1]
            weight = np.exp(-0.5 * (c * u * u - 2 * b * u * v + a * v * v) / (a * c - b * b))
            total += float((weight**2).sum()) * spacing**2 * float((colours[g] ** 2).sum())
        assert energy == pytest.approx(total, rel=1e-4)


@specs
def test_rows_stay_with_their_seeds(spec: ModelSpec) -> None:
    seeds, adam = population(spec)
    before = {name: value.detach().clone() for name, value in seeds.values.items()}
    moments = {group.name: group.means[0].clone() for group in adam.groups}
    kept = torch.tensor([True, False, True, True])
    seeds.keep(kept, adam)
    means = np.full((2, 3), 0.25, np.float32)
    seeds.add(MORE, means, adam)
    assert len(seeds) == 5
    np.testing.assert_array_equal(seeds.layout.corner, np.concatenate([LAYOUT.corner[kept.numpy()], MORE.corner]))
    np.testing.assert_array_equal(seeds.layout.log_size, [3, 3, 2, 2, 1])
    for group in adam.groups:
        value = seeds.values[group.name]
        assert value is group.tensors[0]
        assert value.is_leaf
        assert value.requires_grad
        torch.testing.assert_close(value[:3], before[group.name][kept], rtol=0, atol=0)
        torch.testing.assert_close(group.means[0][:3], moments[group.name][kept], rtol=0, atol=0)
        assert not group.means[0][3:].any()
        assert not group.squares[0][3:].any()
    assert bool((seeds.values["colour" if spec.skip else "scales"][3:] != 0).any())


@specs
def test_gaussians_lie_where_their_seeds_are(spec: ModelSpec) -> None:
    seeds, adam = population(spec)
    seeds.keep(torch.tensor([False, False, False, True]), adam)
    seeds.add(MORE, np.zeros((2, 3), np.float32), adam)
    zeros = torch.zeros(3, spec.attributes)
    centres = np.repeat([[10.0, 10.0], [14.0, 10.0], [13.0, 13.0]], spec.per_seed, axis=0)
    for level in (0, 1):
        means = seeds.gaussians(zeros, level)[0].detach().numpy()
        np.testing.assert_allclose(means, centres * 0.5**level, atol=1e-5)
