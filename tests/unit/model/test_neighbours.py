"""The neighbours of seeds against all distances to seeds of earlier passes."""

import numpy as np
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec._native import MAX_NEIGHBOURS, neighbours_by_pass

small = st.tuples(st.integers(0, 8), st.integers(0, 8))  # many ties and coinciding places
sparse = st.tuples(st.integers(0, 25), st.integers(0, 25))
line = st.tuples(st.integers(0, 5000), st.just(3))
wide = st.tuples(st.integers(0, 2**28), st.integers(0, 2**28))
far = st.tuples(st.integers(2**24 - 9, 2**24), st.integers(2**24 - 9, 2**24))  # one place to a float of 24 bits
beyond_small_keys = st.tuples(st.integers(2**15 - 4, 2**15 + 4), st.integers(0, 8))


def assert_nearest(corner: np.ndarray, log_size: np.ndarray, ranks: int) -> None:
    """By distance between the middles of cells, then by index."""
    middle = 2 * corner.astype(np.int64) + (1 << log_size.astype(np.int64))[:, None]
    earlier = np.zeros(0, np.int64)
    for members, found in neighbours_by_pass(ranks, corner, log_size):
        distance = ((middle[members, None] - middle[earlier]) ** 2).sum(axis=2)
        expected = np.full((len(members), ranks), -1)
        nearest = earlier[np.argsort(distance, axis=1, kind="stable")[:, :ranks]]
        expected[:, : nearest.shape[1]] = nearest
        np.testing.assert_array_equal(found, expected)
        earlier = np.sort(np.concatenate([earlier, members]))
    np.testing.assert_array_equal(earlier, np.arange(len(corner)))


@settings(max_examples=examples(300))
@given(
    st.one_of(
        *(
            st.lists(st.tuples(place, st.integers(0, 7)), max_size=80)
            for place in (small, sparse, line, wide, far, beyond_small_keys)
        )
    ),
    st.integers(1, MAX_NEIGHBOURS),
)
def test_against_all_distances(seeds: list[tuple[tuple[int, int], int]], ranks: int) -> None:
    corner = np.array([place for place, _ in seeds], np.int32).reshape(-1, 2)
    assert_nearest(corner, np.array([level for _, level in seeds], np.int8), ranks)


def test_more_seeds_than_a_node_holds() -> None:
    """In Morton order and out of it."""
    rng = np.random.default_rng(4)
    corner = rng.integers(0, 500, (3000, 2)).astype(np.int32)
    log_size = rng.integers(1, 7, 3000).astype(np.int8)
    order = np.argsort(corner[:, 0] // 32 * 100 + corner[:, 1] // 32, kind="stable")
    assert_nearest(corner[order], log_size[order], 6)
    assert_nearest(corner, log_size, 6)


def test_a_crowd_and_a_few_far_away() -> None:
    """Among so many, distances of the few are beyond what a key says."""
    rng = np.random.default_rng(5)
    corner = np.concatenate([rng.integers(0, 200, (3000, 2)), rng.integers(6000, 8000, (30, 2))]).astype(np.int32)
    log_size = rng.integers(1, 7, len(corner)).astype(np.int8)
    assert_nearest(corner, log_size, 6)
