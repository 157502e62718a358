"""The figures that are reported together, and the picture of the error."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sgicodec.errors import UsageError
from sgicodec.metrics.psnr import psnr
from sgicodec.metrics.scores import error_map, scores


def test_error_map_is_signed_and_amplified() -> None:
    a = np.array([[[100, 100, 100, 100]]], np.uint8)
    b = np.array([[[100, 103, 97, 255]]], np.uint8)
    assert error_map(a, b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    wide_a, wide_b = a.astype(np.uint16) * 257, b.astype(np.uint16) * 257
    assert error_map(wide_a, wide_b, gain=10).tolist() == [[[128, 158, 98, 255]]]
    with pytest.raises(UsageError, match="gain"):
        error_map(a, b, gain=0)


@pytest.mark.parametrize("measure", [psnr, scores])
def test_unlike_pictures_are_refused(measure: Callable) -> None:
    a = np.zeros((12, 14, 3), np.uint8)
    with pytest.raises(UsageError, match="14x12 with 3 channels and 12x14 with 3 channels"):
        measure(a, np.zeros((14, 12, 3), np.uint8))
    with pytest.raises(UsageError, match="uint8 and uint16"):
        measure(a, a.astype(np.uint16))
    with pytest.raises(UsageError, match=r"\[H, W, C\]"):
        measure(a[..., 0], a[..., 0])
    with pytest.raises(UsageError, match="int32"):
        measure(a.astype(np.int32), a.astype(np.int32))
