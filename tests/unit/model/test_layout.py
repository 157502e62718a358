"""Where seeds sit: tilings, counts and orders, checked pixel by pixel and path by path."""

import numpy as np
from examples import examples
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sgicodec.model.layout import ROOT_LOG, SeedLayout, adaptive_layout, cell_sums, uniform_layout


def path_of(x: int, y: int, log_size: int) -> tuple[list[int], int]:
    """The way from the root to a cell, one child at a time; parents sort before their first child."""
    return [(y >> bit & 1) * 2 + (x >> bit & 1) for bit in range(30, -1, -1)], -log_size


def in_canonical_order(layout: SeedLayout) -> bool:
    paths = [path_of(int(x), int(y), int(k)) for (x, y), k in zip(layout.corner, layout.log_size, strict=True)]
    return paths == sorted(paths)


def cover(layout: SeedLayout, width: int, height: int) -> np.ndarray:
    """How many cells each pixel lies in."""
    count = np.zeros((height, width), int)
    for (x, y), k in zip(layout.corner, layout.log_size, strict=True):
        count[y : y + (1 << k), x : x + (1 << k)] += 1
    return count


def picture(seed: int, channels: int, width: int, height: int) -> np.ndarray:
    """Smooth on the left, rough on the right."""
    rng = np.random.default_rng(seed)
    rough = rng.normal(size=(channels, height, width)) * np.linspace(0, 1, width) ** 3
    return (0.02 * np.arange(height)[:, None] + rough).astype(np.float32)


@settings(max_examples=examples(30))
@given(
    st.integers(1, 150),
    st.integers(1, 150),
    st.sampled_from([1, 3]),
    st.floats(0, 30),
    st.integers(1, 3),
    st.integers(0, 100),
)
def test_adaptive_leaves_tile_the_picture(
    width: int, height: int, channels: int, threshold: float, min_log: int, seed: int
) -> None:
    layout = adaptive_layout(picture(seed, channels, width, height), threshold, min_log)
    assert np.all(cover(layout, width, height) == 1)
    assert in_canonical_order(layout)
    assert layout.log_size.min() >= min_log
    assert layout.log_size.max() <= ROOT_LOG
    assert not np.any(layout.corner & ((1 << layout.log_size.astype(np.int64))[:, None] - 1))  # on their own grid
    assert (layout.corner.dtype, layout.log_size.dtype) == (np.int32, np.int8)


def test_leaves_are_those_below_the_threshold() -> None:
    detail, threshold = picture(3, 3, 128, 64), 4.0
    layout = adaptive_layout(detail, threshold)

    def deviation(x: int, y: int, k: int) -> float:
        cell = detail[:, y : y + (1 << k), x : x + (1 << k)].astype(np.float64)
        return float(np.sum((cell - cell.mean(axis=(1, 2), keepdims=True)) ** 2))

    cells = [(int(x), int(y), int(k)) for (x, y), k in zip(layout.corner, layout.log_size, strict=True)]
    assert {k for _, _, k in cells} > {1, 3}
    for x, y, k in cells:
        assert k == 1 or deviation(x, y, k) <= threshold
        if k < ROOT_LOG:
            parent = x >> (k + 1) << (k + 1), y >> (k + 1) << (k + 1)
            assert deviation(*parent, k + 1) > threshold


def test_weighted_cell_sums_are_sums_over_cells() -> None:
    """With the border's weights beside the picture; what deviates from the weighted mean is squares less held."""
    detail = picture(1, 2, 19, 13).astype(np.float64)
    weights = np.random.default_rng(3).uniform(0.2, 3, (13, 19))
    sums = cell_sums(detail.astype(np.float32), 3, weights.astype(np.float32))
    every, values = np.pad(weights, [(0, 3), (0, 5)], mode="edge"), np.pad(detail, [(0, 0), (0, 3), (0, 5)])
    for level in range(1, 4):
        side = 1 << level
        for row, column in np.ndindex(sums.squares[level].shape):
            part = np.s_[row * side : (row + 1) * side, column * side : (column + 1) * side]
            w, d = every[part], values[:, *part]
            mean = (w * d).sum(axis=(1, 2)) / w.sum()
            np.testing.assert_allclose(sums.values[level][:, row, column], mean * w.sum(), atol=1e-5)
            deviation = (w * (d - mean[:, None, None]) ** 2).sum()
            found = sums.squares[level][row, column] - sums.held(level)[row, column]
            np.testing.assert_allclose(found, deviation, atol=1e-5)


@given(st.integers(1, 90), st.integers(1, 90), st.floats(0, 1.1), st.integers(0, 1000))
@example(width=12, height=3, share=0.6875, seed=0)
def test_uniform_seeds_are_as_many_as_asked_for_and_inside(width: int, height: int, share: float, seed: int) -> None:
    count = max(1, round(share * width * height))
    layout = uniform_layout(width, height, count, np.random.default_rng(seed))
    assert len(layout) == min(count, width * height)
    assert np.all(layout.corner >= 0)
    assert np.all(layout.corner < [width, height])
    assert len(np.unique(layout.corner, axis=0)) == len(layout)
    assert not layout.log_size.any()
    assert in_canonical_order(layout)
