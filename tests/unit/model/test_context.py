"""What MLP_p sees: reach, weights and causality."""

import dataclasses

import numpy as np
import pytest

from sgicodec._native import neighbour_weight
from sgicodec.model.context import (
    INPUT_BITS,
    SUMMARY,
    HashGrid,
    hash_inputs,
    input_count,
    level_inputs,
    nearest_offset,
    neighbour_inputs,
    neighbour_table,
    output_columns,
    output_count,
    own_inputs,
    passes,
)
from sgicodec.model.layout import SeedLayout, adaptive_layout, uniform_layout
from sgicodec.model.neighbours import nearest_seeds
from sgicodec.model.spec import ContextSpec, ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

WIDTH, HEIGHT = 150, 90
DETAIL = np.random.default_rng(0).normal(size=(3, HEIGHT, WIDTH)).astype(np.float32)
DETAIL *= np.linspace(0, 1, WIDTH, dtype=np.float32) ** 2
LAYOUT = adaptive_layout(DETAIL, 5.0)
DEFAULT, PAPER = default_spec(3).context, paper_spec(3).context


def shift(value: np.ndarray, bits: int) -> np.ndarray:
    return value >> bits


@pytest.mark.parametrize(("width", "height"), [(WIDTH, HEIGHT), (7, 400), (1, 1)])
def test_hash_grid_weights_and_reach(width: int, height: int) -> None:
    layout = uniform_layout(width, height, 300, np.random.default_rng(0))
    grid = HashGrid.at(PAPER, layout, width, height)
    levels = len(PAPER.hash_resolutions)
    assert grid.entry.shape == grid.weight.shape == (levels, len(layout), 4)
    assert np.all(grid.weight.sum(axis=2) == 4096)
    assert grid.weight.min() >= 0
    assert len(grid.sizes) == levels
    assert max(grid.sizes) <= 1 << PAPER.hash_log2_entries
    for entry, size in zip(grid.entry, grid.sizes, strict=True):
        assert entry.min() >= 0
        assert entry.max() < size


def test_a_dense_level_interpolates_linearly() -> None:
    """Tables that hold x or y of their vertex come back as the seed's position in cells, to the fixed point's 1/64."""
    spec = dataclasses.replace(PAPER, hash_resolutions=(18, 44))
    grid = HashGrid.at(spec, LAYOUT, WIDTH, HEIGHT)
    for level, resolution in enumerate(spec.hash_resolutions):
        across = resolution + 1
        vertex = np.arange(grid.sizes[level])
        table = np.stack([vertex % across, vertex // across], axis=1)
        one_level = HashGrid(
            grid.entry[level : level + 1], grid.weight[level : level + 1], grid.sizes[level : level + 1]
        )
        found = hash_inputs(one_level, slice(None), [table], one_level.weight, np.concatenate, shift)
        expected = LAYOUT.centre * resolution / max(WIDTH, HEIGHT)
        assert np.all(found == np.floor(expected * (1 << INPUT_BITS)))


def test_equal_signs_give_one() -> None:
    grid = HashGrid.at(PAPER, LAYOUT, WIDTH, HEIGHT)
    tables = [np.full((size, PAPER.hash_features), -1 if i % 2 else 1) for i, size in enumerate(grid.sizes)]
    members = np.array([5, 3, 0])
    found = hash_inputs(grid, members, tables, grid.weight, np.concatenate, shift)
    sign = np.where(np.arange(len(grid.sizes)) % 2, -1, 1).repeat(PAPER.hash_features)
    np.testing.assert_array_equal(found, np.broadcast_to(sign << INPUT_BITS, (3, len(sign))))


def test_a_fine_level_hashes_without_piling_up() -> None:
    spec = dataclasses.replace(PAPER, hash_resolutions=(514,))
    grid = HashGrid.at(spec, uniform_layout(514, 514, 20_000, np.random.default_rng(1)), 514, 514)
    assert grid.sizes == (8192,)
    load = np.bincount(grid.entry[0, :, 0], minlength=8192)
    assert load.max() < 20  # 2.4 on average


def neighbours_by_brute_force(spec: ContextSpec, layout: SeedLayout) -> list[list[int]]:
    centre = layout.half_pixels.astype(np.int64)
    expected: list[list[int]] = [[] for _ in range(len(layout))]
    earlier: list[int] = []
    for members in passes(spec, layout):
        for seed in members:
            distance = np.sum((centre[earlier] - centre[seed]) ** 2, axis=1) if earlier else []
            order = sorted(zip(distance, earlier, strict=True))
            expected[seed] = [int(index) for _, index in order[: spec.neighbours]]
        earlier += members.tolist()
    return expected


@pytest.mark.parametrize("layout", [LAYOUT, LAYOUT.take(np.arange(9)), LAYOUT.take(np.arange(1))])
def test_neighbours_are_the_nearest_of_earlier_passes(layout: SeedLayout) -> None:
    table, present = neighbour_table(DEFAULT, layout, nearest_seeds)
    assert table.shape == present.shape == (len(layout), DEFAULT.neighbours)
    for seed, expected in enumerate(neighbours_by_brute_force(DEFAULT, layout)):
        assert present[seed].tolist() == [1] * len(expected) + [0] * (DEFAULT.neighbours - len(expected))
        assert table[seed, : len(expected)].tolist() == expected
    turn = np.empty(len(layout), int)
    for number, members in enumerate(passes(DEFAULT, layout)):
        turn[members] = number
    assert np.all((turn[table] < turn[:, None]) | (present == 0))


def test_level_inputs() -> None:
    found = level_inputs(LAYOUT, 90)
    for row, k in zip(found, LAYOUT.log_size, strict=True):
        assert row.tolist() == [64 * (k == level) for level in range(8)] + [90 * 64 // 12]


def test_neighbour_inputs_by_the_format() -> None:
    """docs/format.md, "Context model", inputs 2, one seed at a time in Python's integers."""
    rng = np.random.default_rng(3)
    summary = rng.integers(-900, 900, (len(LAYOUT), SUMMARY))
    table, present = neighbour_table(DEFAULT, LAYOUT, nearest_seeds)
    sizes = LAYOUT.log_size.astype(np.int64)
    offset = nearest_offset(LAYOUT, table)
    found = neighbour_inputs(summary, table, present, (sizes, sizes), offset, np.concatenate, shift)
    centre = LAYOUT.half_pixels.astype(int).tolist()
    for seed in range(len(LAYOUT)):
        ranks = [(neighbour_weight(r), int(table[seed, r])) for r in range(DEFAULT.neighbours) if present[seed, r]]
        k = int(sizes[seed])
        expected = [sum(64 * w for w, _ in ranks) >> 4]
        expected += [sum(w * int(summary[i, j]) for w, i in ranks) >> 4 for j in range(SUMMARY)]
        expected += [sum(w * abs(int(summary[i, j])) for w, i in ranks) >> 4 for j in (0, 1, 2, 5, 6)]
        expected += [sum(64 * w * (int(sizes[i]) - k) for w, i in ranks) >> 4]
        if ranks:
            nearest = ranks[0][1]
            expected += summary[nearest].tolist()
            distance = [centre[nearest][d] - centre[seed][d] for d in (0, 1)]
            expected += [min(max((64 * d) >> (k + 1), -512), 512) for d in distance]
        else:
            expected += [0] * (SUMMARY + 2)
        assert found[seed].tolist() == expected


def test_own_inputs() -> None:
    summary = np.array([[1, -2, 3, 40, -5, 6, -7]])
    assert own_inputs(summary, 1, np.concatenate).tolist() == [[1, -2, 3, 1, 2, 3, 40]]
    assert own_inputs(summary, 2, np.concatenate).tolist() == [[1, -2, 3, 1, 2, 3, 40, -5, 6, -7, 6, 7]]


@pytest.mark.parametrize("spec", [default_spec(3), default_spec(1), default_spec(6), paper_spec(3, 2, 6)])
def test_every_attribute_has_a_prediction(spec: ModelSpec) -> None:
    for group in spec.groups:
        columns = output_columns(spec, group.name)
        assert columns.shape == (group.size,)
        assert set(columns.tolist()) <= set(range(output_count(spec, group.name)))
    colour = [0, 1, 2, 0, 0, 0] if spec.channels == 6 else [0, 1, 2] if spec.channels == 3 else [0]
    if spec.skip:
        assert output_columns(spec, "colour").tolist() == colour
        assert output_columns(spec, "shape").tolist() == [0, 1, 2]


@pytest.mark.parametrize("spec", [default_spec(3), default_spec(1)])
def test_input_count_is_what_the_blocks_hold(spec: ModelSpec) -> None:
    table, present = neighbour_table(spec.context, LAYOUT, nearest_seeds)
    summary, sizes = np.zeros((len(LAYOUT), SUMMARY), np.int64), LAYOUT.log_size.astype(np.int64)
    beside = neighbour_inputs(summary, table, present, (sizes, sizes), table[:, :2], np.concatenate, shift)
    common = level_inputs(LAYOUT, 0).shape[1] + beside.shape[1]
    assert input_count(spec, 0) == common
    for step in (1, 2):
        assert input_count(spec, step) == common + own_inputs(summary, step, np.concatenate).shape[1]
    paper = paper_spec(3)
    grid = HashGrid.at(paper.context, LAYOUT, WIDTH, HEIGHT)
    tables = [np.ones((size, paper.context.hash_features), np.int64) for size in grid.sizes]
    hashed = hash_inputs(grid, slice(None), tables, grid.weight, np.concatenate, shift)
    assert input_count(paper, 0) == level_inputs(LAYOUT, 0).shape[1] + hashed.shape[1]
