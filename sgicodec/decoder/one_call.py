"""A stream to an array in one call: `decode` and `imread`."""

from __future__ import annotations

import os
from typing import Any

from numpy.typing import DTypeLike, NDArray

from sgicodec.decoder.stream import BytesLike, Size, open_stream
from sgicodec.decoder.view import Region
from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import UsageError

__all__ = ["decode", "imread"]


def decode(
    data: BytesLike,
    *,
    region: Region | None = None,
    scale: float | None = None,
    size: Size | None = None,
    dtype: DTypeLike | None = None,
    device: Device = ALL_CORES,
) -> NDArray[Any]:
    """The samples of a stream in memory, or of a part of it: [H, W] of gray, else [H, W, C]. See `Stream.read`."""
    if isinstance(data, str | os.PathLike):
        raise UsageError("decode takes the bytes of a stream; imread takes a path")
    with open_stream(data, device) as stream:
        return stream.read(region, scale, size, dtype)


def imread(
    path: str | os.PathLike[str],
    *,
    region: Region | None = None,
    scale: float | None = None,
    size: Size | None = None,
    dtype: DTypeLike | None = None,
    device: Device = ALL_CORES,
) -> NDArray[Any]:
    """The same of a file, of which no more is read than the part needs."""
    if not isinstance(path, str | os.PathLike):
        raise UsageError(f"a {type(path).__name__} is no path; decode takes bytes")
    with open_stream(path, device) as stream:
        return stream.read(region, scale, size, dtype)
