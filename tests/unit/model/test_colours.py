"""Channels of models: the matrices of docs/format.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sgicodec.model.colours import to_channels, to_samples
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

ORTHONORMAL = np.array([[1, 1, 1], [1, 0, -1], [-1, 2, -1]]) / np.sqrt([[3], [2], [6]])
LUMA_SPACE = np.array(
    [
        3**0.5 * np.array([1 / 4, 5 / 8, 1 / 8]),
        0.65 / 2**0.5 * np.array([1, 0, -1]),
        0.5 * 1.5**0.5 * np.array([-1 / 2, 5 / 4, -3 / 4]),
    ]
)


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("luma_space", [False, True])
def test_the_matrices_of_the_page(channels: int, luma_space: bool) -> None:
    spec = replace(default_spec(channels), luma_space=luma_space)
    page = np.eye(channels)
    page[:3, :3] = LUMA_SPACE if luma_space else ORTHONORMAL
    np.testing.assert_allclose(to_channels(spec), page, atol=1e-12)
    np.testing.assert_allclose(to_samples(spec) @ page, np.eye(channels), atol=1e-12)


def test_others_are_samples() -> None:
    for spec in (default_spec(2), paper_spec(3)):
        np.testing.assert_array_equal(to_channels(spec), np.eye(spec.channels))
