"""Luma space: the matrices of docs/format.md, and pictures that come back in their own colours."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.luma_space import from_luma_space, to_luma_space

PAGE = np.array(
    [
        3**0.5 * np.array([1 / 4, 5 / 8, 1 / 8]),
        0.65 / 2**0.5 * np.array([1, 0, -1]),
        0.5 * 1.5**0.5 * np.array([-1 / 2, 5 / 4, -3 / 4]),
    ]
)


@pytest.mark.parametrize("channels", [3, 4])
def test_the_matrices_of_the_page(channels: int) -> None:
    page = np.eye(channels)
    page[:3, :3] = np.linalg.inv(PAGE) @ np.array(colour_matrix(3))
    np.testing.assert_allclose(from_luma_space(channels), page, atol=1e-12)
    np.testing.assert_allclose(to_luma_space(channels) @ page, np.eye(channels), atol=1e-12)
