"""The search against all distances."""

import numpy as np
import pytest
from examples import examples
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scenes import ISAS

from sgicodec._native import nearest_among

small = st.tuples(st.integers(0, 8), st.integers(0, 8))  # many ties and coinciding points
sparse = st.tuples(st.integers(0, 25), st.integers(0, 25))
line = st.tuples(st.integers(0, 5000), st.just(3))
wide = st.tuples(st.integers(-(2**29), 2**29), st.integers(-(2**29), 2**29))
far = st.tuples(st.integers(2**25 - 9, 2**25), st.integers(2**25 - 9, 2**25))  # one place to a float of 24 bits
beyond_small_keys = st.tuples(st.integers(2**16 - 4, 2**16 + 4), st.integers(-(2**16) - 4, -(2**16) + 4))
Points = list[tuple[int, int]]


def brute(points: Points, queries: Points, k: int) -> list[list[int]]:
    """Sorted by distance, then by index, in Python's integers."""
    result = []
    for x, y in queries:
        order = sorted((((px - x) ** 2 + (py - y) ** 2), i) for i, (px, py) in enumerate(points))
        found = [i for _, i in order[:k]]
        result.append(found + [-1] * (k - len(found)))
    return result


def as_array(points: Points) -> np.ndarray:
    return np.array(points, np.int32).reshape(-1, 2)


def nearest_seeds(points: np.ndarray, among: np.ndarray, members: np.ndarray, k: int, isa: str = "auto") -> np.ndarray:
    out = np.empty((len(members), k), np.int32)
    nearest_among(points, among, members, out, 2, isa)
    return out


def nearest_points(points: np.ndarray, queries: np.ndarray, k: int) -> np.ndarray:
    """Of all `points`, for each of `queries`."""
    n, m = len(points), len(queries)
    return nearest_seeds(np.concatenate([points, queries]), np.arange(n), n + np.arange(m), k)


@settings(max_examples=examples(300))
@given(
    st.one_of(
        *(
            st.tuples(st.lists(p, max_size=60), st.lists(p, max_size=20))
            for p in (small, sparse, line, wide, far, beyond_small_keys)
        )
    ),
    st.integers(1, 7),
)
@example(([(0, 0)], [(2**29, 2**29), (-(2**29), 5)]), 2)
@example(([(0, 0), (0, 0), (4, 0), (0, 4)], [(2, 2), (9, 9)]), 3)
def test_against_all_distances(both: tuple[Points, Points], k: int) -> None:
    points, queries = both
    found = nearest_points(as_array(points), as_array(queries), k)
    assert found.shape == (len(queries), k)
    assert found.tolist() == brute(points, queries, k)


def test_some_seeds_among_others() -> None:
    rng = np.random.default_rng(2)
    points = rng.integers(0, 60, (400, 2)).astype(np.int32)
    chosen = rng.permutation(400)
    among, members = np.sort(chosen[:150]), chosen[150:260]
    distance = np.sum((points[members][:, None].astype(np.int64) - points[among]) ** 2, axis=2)
    expected = among[np.argsort(distance, axis=1, kind="stable")[:, :5]]
    np.testing.assert_array_equal(nearest_seeds(points, among, members, 5), expected)
    few = nearest_seeds(points, among[:2], members, 3)
    assert np.all(few[:, 2] == -1)
    assert set(few[:, :2].ravel().tolist()) <= set(among[:2].tolist())
    with pytest.raises(ValueError, match="indices of points"):
        nearest_seeds(points, np.array([400]), members, 1)


@pytest.mark.parametrize("isa", ISAS)
def test_every_instruction_set_finds_the_same(isa: str) -> None:
    """With seeds in Morton order and more of them than a node holds."""
    rng = np.random.default_rng(4)
    points = rng.integers(0, 500, (6000, 2)).astype(np.int32)
    points = points[np.argsort(points[:, 0] // 32 * 100 + points[:, 1] // 32, kind="stable")]
    among, members = np.arange(0, 6000, 2), np.arange(1, 6000, 20)
    distance = np.sum((points[members][:, None].astype(np.int64) - points[among]) ** 2, axis=2)
    expected = among[np.argsort(distance, axis=1, kind="stable")[:, :6]]
    np.testing.assert_array_equal(nearest_seeds(points, among, members, 6, isa), expected)
