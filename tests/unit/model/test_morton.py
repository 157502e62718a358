import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.model.morton import canonical_order, morton

coordinate = st.integers(0, 2**31 - 1)


@given(coordinate, coordinate)
def test_bits_alternate(x: int, y: int) -> None:
    expected = sum((x >> i & 1) << 2 * i | (y >> i & 1) << 2 * i + 1 for i in range(31))
    code = morton(np.array([x]), np.array([y]))
    assert code.tolist() == [expected]


def test_canonical_order_is_a_walk_through_the_tree() -> None:
    corner = np.array([[4, 4], [4, 0], [0, 4], [0, 0], [0, 0], [2, 0], [0, 0]])
    log_size = np.array([2, 2, 2, 3, 0, 1, 2], np.int8)
    assert canonical_order(corner, log_size).tolist() == [3, 6, 4, 5, 1, 2, 0]
