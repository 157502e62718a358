from __future__ import annotations

import numpy as np
import pytest

from sgicodec.metadata.orientation import is_sideways, upright

STORED = np.array([[1, 2, 3], [4, 5, 6]])[..., None]

# TIFF 6.0, tag 274: where the stored row 0 and column 0 are to be seen.
SEEN = {
    1: [[1, 2, 3], [4, 5, 6]],  # row 0 top, column 0 left
    2: [[3, 2, 1], [6, 5, 4]],  # top, right
    3: [[6, 5, 4], [3, 2, 1]],  # bottom, right
    4: [[4, 5, 6], [1, 2, 3]],  # bottom, left
    5: [[1, 4], [2, 5], [3, 6]],  # left, top
    6: [[4, 1], [5, 2], [6, 3]],  # right, top
    7: [[6, 3], [5, 2], [4, 1]],  # right, bottom
    8: [[3, 6], [2, 5], [1, 4]],  # left, bottom
}


@pytest.mark.parametrize("orientation", range(1, 9))
def test_the_eight_orientations(orientation: int) -> None:
    seen = upright(STORED, orientation)
    assert seen[..., 0].tolist() == SEEN[orientation]
    assert seen.flags.c_contiguous
    assert is_sideways(orientation) == (seen.shape[:2] != STORED.shape[:2])


@pytest.mark.parametrize("orientation", [0, 9, -1, 65535])
def test_nonsense_means_upright(orientation: int) -> None:
    assert upright(STORED, orientation).tolist() == STORED.tolist()
