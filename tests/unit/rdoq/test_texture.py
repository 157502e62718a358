"""The search for texture: what it counts is what is written, and what it finds pays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import crop
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from symbols import SymbolReader, SymbolWriter, write_texture
from textures import assert_same, read_texture

from sgicodec.device import Device
from sgicodec.model.texture_symbols import (
    LAPPED,
    SAME_COLOURS,
    SAME_STEP,
    TextureGrid,
    TextureIndices,
    TextureSymbols,
    roots_of,
)
from sgicodec.rdoq.texture import TextureSearch

SAME = SAME_STEP, SAME_STEP
OTHERS = 44, 24, 13
PRICE = 0.11
"""λ in squared steps, about what is right at high rates."""


@pytest.fixture(scope="module")
def residual() -> np.ndarray:
    """160×96 pixels of a photograph, [C, H, W] without their mean."""
    pixels = crop("kodim13", np.s_[300:396, 100:260]).pixels.astype(np.float32) / 255
    planes = pixels.transpose(2, 0, 1)
    return np.ascontiguousarray(planes - planes.mean(axis=(1, 2), keepdims=True))


def payload_of(layer: TextureSymbols) -> tuple[bytes, float]:
    writer = SymbolWriter()
    write_texture(writer, layer.size, len(layer.symbols), layer)
    return writer.finish(), writer.bits


def squared_error(residual: np.ndarray, layer: TextureSymbols) -> float:
    return float(((residual - layer.draw()).astype(np.float64) ** 2).sum())


@pytest.mark.parametrize("width", [96, 97, 100, 104, 112, 120, 125])
@pytest.mark.parametrize("height", [64, 72, 75, 80])
@pytest.mark.parametrize("grid", [LAPPED, TextureGrid(True, 0, 0), TextureGrid(True, 7, 3)])
def test_fine_steps_show_all_up_to_the_edges(residual: np.ndarray, width: int, height: int, grid: TextureGrid) -> None:
    """Wherever a tile ends: in the middle of a root, of a cell, or where cells of 8 pixels end."""
    part = np.ascontiguousarray(residual[:, :height, :width])
    layer = TextureSearch(part, grid=grid).at(TextureIndices(140, SAME), 1e-3, None)
    error = np.abs(part - layer.draw())
    assert error.max() < 1.5 * TextureIndices(140, SAME).of_channels.max()


@pytest.mark.parametrize("has_contrast", [False, True])
@pytest.mark.parametrize("colours", [SAME_COLOURS, OTHERS])
def test_symbols_are_counted_by_magnitude(
    residual: np.ndarray, has_contrast: bool, colours: tuple[int, int, int]
) -> None:
    contrast = np.zeros((3, 5), np.int8)
    if has_contrast:
        contrast[:] = np.random.default_rng(0).integers(-3, 4, contrast.shape)
    steps = TextureIndices(340, SAME, (0, 0), (8, 8, 8), has_contrast, colours=colours)
    search = TextureSearch(residual, colours=colours)
    parts, counts, _ = search._amplitudes.search(contrast, steps, PRICE, search.split_margin, None)
    layer = TextureSymbols((160, 96), steps, *parts)
    magnitude = np.abs(layer.symbols)
    assert counts == [(magnitude == 1).sum(), (magnitude == 2).sum(), (magnitude > 2).sum()]


def test_what_is_found_pays(residual: np.ndarray) -> None:
    """Less error than nothing by more than λ times the bits; finer steps leave less, for more bytes."""
    search, nothing = TextureSearch(residual), float((residual.astype(np.float64) ** 2).sum())
    errors, sizes = [nothing], [0]
    for step in (400, 350, 300, 250):
        layer = search.at(TextureIndices(step, SAME), PRICE)
        assert layer is not None
        payload, bits = payload_of(layer)
        error, lmbda = squared_error(residual, layer), PRICE * layer.steps.of_channels[0] ** 2
        assert error + lmbda * bits < nothing
        assert error < errors[-1]
        assert len(payload) > sizes[-1]
        errors.append(error)
        sizes.append(len(payload))
    assert errors[-1] < 0.01 * nothing


@settings(max_examples=examples(40))
@given(
    st.integers(1, 4),
    st.integers(1, 100),
    st.integers(1, 70),
    st.integers(0, 2**32),
    st.integers(200, 480),
    st.tuples(st.integers(0, 31), st.integers(0, 31)),
)
def test_what_is_found_can_always_be_written(
    channels: int, width: int, height: int, seed: int, step: int, slopes: tuple[int, int]
) -> None:
    """Also where the tile ends inside cells, where slopes are steep, and where texture is rare."""
    rng = np.random.default_rng(seed)
    planes = rng.normal(0, 0.1, (channels, height, width)) * (rng.random((channels, height, width)) < rng.random())
    grid = TextureGrid(True, *rng.integers(0, 8, 2).tolist()) if seed % 3 == 0 else LAPPED
    columns, rows = roots_of(*grid.layer_size((width, height)))
    contrast = rng.integers(-15, 16, (rows, columns)).astype(np.int8)
    steps = TextureIndices(step, (SAME_STEP,) * (channels - 1), slopes, (8, 8, 8), bool(seed % 2))
    layer = TextureSearch(planes.astype(np.float32), grid=grid).at(steps, PRICE, contrast)
    if layer is None:
        return
    reader = SymbolReader(payload_of(layer)[0])
    found = read_texture(reader, layer.size, channels)
    reader.finish()
    assert found is not None
    assert_same(found, layer)


def test_an_estimate_says_which_cells_cost_less(residual: np.ndarray) -> None:
    """Blocks of one frequency cost less in separate cells on their grid than beside it, or in ones that lap over."""
    wave = np.cos(np.pi * 3 * (np.arange(8) + 0.5) / 8)
    planes = np.kron(residual[:, ::8, ::8], np.outer(wave, wave)).astype(np.float32)
    steps, grids = TextureIndices(300, SAME), [LAPPED, TextureGrid(True, 0, 0), TextureGrid(True, 4, 4)]
    searches = [TextureSearch(planes, grid=grid) for grid in grids]
    lapped, here, beside = (search.estimate(steps, PRICE, None) for search in searches)
    assert here < 0.5 * min(lapped, beside)
    layers = [search.at(steps, PRICE) for search in searches]
    sizes = [payload_of(layer)[1] for layer in layers if layer is not None]
    assert sizes[1] < 0.5 * min(sizes[0], sizes[2])


@pytest.mark.parametrize("colours", [SAME_COLOURS, OTHERS])
def test_amplitudes_move_up_a_gradient_by_a_part_of_their_steps(
    residual: np.ndarray, colours: tuple[int, int, int]
) -> None:
    steps, fine = TextureIndices(400, SAME, (2, 4)), TextureIndices(200, SAME)
    gradient = np.random.default_rng(0).normal(size=residual.shape).astype(np.float32)
    mean, most = 0.05, 0.2

    def moved(threads: int, times: int = 1) -> np.ndarray:
        search = TextureSearch(residual, Device(threads), colours=colours)
        for _ in range(times):
            search.move(gradient, steps, None, mean, most)
        layer = search.at(fine, 0.0)
        return layer.draw()

    still, once = moved(1, 0), moved(1)
    assert np.array_equal(once, moved(3))
    away = (once - still).astype(np.float64)
    assert (away * gradient).sum() > 0.3 * np.sqrt((away**2).sum() * (gradient.astype(np.float64) ** 2).sum())
    # amplitudes are orthonormal: in the mean they move by less than `most` of their largest step
    largest = steps.of_channels.max() * (1 + max(steps.growth))
    assert 0.05 * mean * steps.of_channels.min() < np.sqrt((away**2).mean()) < most * largest


def test_amplitudes_of_given_blocks_alone_move(residual: np.ndarray) -> None:
    """Those that blocks of other sizes would have at their places stay."""
    steps = TextureIndices(380, SAME)
    gradient = np.random.default_rng(0).normal(size=residual.shape).astype(np.float32)
    search, still, all_move = TextureSearch(residual), TextureSearch(residual), TextureSearch(residual)
    blocks = search.at(steps, PRICE)
    assert blocks is not None
    search.move(gradient, steps, None, 0.05, 0.2, blocks)
    all_move.move(gradient, steps, None, 0.05, 0.2)
    for log in (3, 4, 5):
        of_size = replace(blocks, log_size=np.full_like(blocks.log_size, log))
        finest = (one.at(TextureIndices(60, SAME), 0.0, blocks=of_size) for one in (still, search, all_move))
        before, after, every = (layer.symbols.astype(np.float64) for layer in finest if layer is not None)
        here = np.repeat(np.repeat(blocks.log_size == log, 8, axis=0), 8, axis=1)
        assert np.array_equal(after[:, ~here], before[:, ~here])
        if here.any():
            ways = ((one - before)[:, here] for one in (after, every))
            assert np.corrcoef(*(way.ravel() for way in ways))[0, 1] > 0.99


def test_given_cells_are_taken_but_for_those_without_symbols(residual: np.ndarray) -> None:
    search, steps = TextureSearch(residual), TextureIndices(340, SAME)
    best = search.at(steps, PRICE)
    assert best is not None
    again = search.at(steps, PRICE, blocks=best)
    assert np.array_equal(again.log_size, best.log_size)
    bits = [payload_of(layer)[1] for layer in (best, again)]
    costs = [squared_error(residual, layer) / steps.of_channels[0] ** 2 for layer in (best, again)]
    assert costs[1] + PRICE * bits[1] == pytest.approx(costs[0] + PRICE * bits[0], rel=0.01)

    coarse = search.at(TextureIndices(420, SAME), PRICE, blocks=best)
    left = coarse.log_size > 0
    assert 0 < left.sum() < (best.log_size > 0).sum()
    assert np.array_equal(coarse.log_size[left], best.log_size[left])
    assert payload_of(coarse)[1] < 0.5 * bits[0]


@pytest.mark.parametrize("wrong", ["shape", "size", "tree"])
def test_cells_that_are_no_layer_of_the_tile(residual: np.ndarray, wrong: str) -> None:
    search, steps = TextureSearch(residual), TextureIndices(340, SAME)
    cells = search.at(steps, PRICE)
    assert cells is not None
    log_size = {"shape": np.zeros((4, 4)), "size": np.full((12, 20), 2), "tree": np.eye(12, 20) * 5}[wrong]
    with pytest.raises(ValueError, match=r"division|log_size|cells"):
        search.at(steps, PRICE, blocks=replace(cells, log_size=log_size.astype(np.uint8)))
