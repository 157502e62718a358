from __future__ import annotations

import numpy as np
import pytest

from sgicodec.metadata.motion import Motion, scaled_ratio
from sgicodec.metadata.orientation import upright


@pytest.mark.parametrize("turn", range(1, 9))
def test_points_go_where_pixels_go(turn: int) -> None:
    stored = np.zeros((5, 7, 1), np.uint8)
    stored[1, 4] = 1
    y, x, _ = np.argwhere(upright(stored, turn))[0]
    motion = Motion(7, 5, turn)
    assert motion.point(4, 1) == (x, y)
    assert motion.size_of_all(7, 5) == upright(stored, turn).shape[1::-1]
    assert motion.is_none == (turn == 1)


def test_a_view() -> None:
    view = Motion(10, 8, 1, 2, 3, 2, 4, 8, 8)
    assert view.point(4, 4) == (5, 6)
    assert view.point(1, 4) is view.point(6, 4) is None
    assert (view.is_whole, view.is_none) == (False, False)
    assert Motion(10, 8, 1, 0, 0, 0.3, 0.25, 3, 2).is_whole
    assert Motion(10, 8, 1, 0, 0, 1, 1, 10, 8).is_none


def test_a_ratio_stays_in_32_bits() -> None:
    assert scaled_ratio(300, 1, 1 / 3) == (100, 1)
    assert scaled_ratio((1 << 32) - 1, 1, 9.0) == ((1 << 32) - 1, 1)
    assert scaled_ratio(7, 0, 2.0) == (7, 0)
