"""What references of native scores share: the original's shape, and pictures as native code takes them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.errors import UsageError

__all__ = ["NativeReference"]

F32 = NDArray[np.float32]
Native = TypeVar("Native")


class NativeReference(Generic[Native]):
    """An original [C, H, W] in native code, and the check of decoded pictures against its shape."""

    def __init__(self, make: Callable[[F32, int, str], Native], original: F32, device: Device) -> None:
        """Raises UsageError unless `original` has three dimensions and samples."""
        if original.ndim != 3 or original.size == 0:
            raise UsageError(f"a picture must be a filled array [C, H, W], not of shape {original.shape}")
        self._shape = original.shape
        self._native = make(_plain(original), device.threads, device.isa)

    def _checked(self, decoded: F32) -> F32:
        if decoded.shape != self._shape:
            raise UsageError(f"a decoded picture of shape {decoded.shape} does not fit the original's {self._shape}")
        return _plain(decoded)


def _plain(picture: F32) -> F32:
    return np.ascontiguousarray(picture, np.float32)
