"""A stream to an array in one call: `decode` and `imread`."""

from __future__ import annotations

import os
from typing import Any

from numpy.typing import DTypeLike, NDArray

from sgicodec.decoder.stream import BytesLike, Size, open_stream
from sgicodec.decoder.view import Region
from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import UsageError


def decode(
    data: BytesLike,
    *,
    region: Region | None = None,
    scale: float | None = None,
    size: Size | None = None,
    dtype: DTypeLike | None = None,
    device: Device = ALL_CORES,
) -> NDArray[Any]:
    """The samples of a stream in memory, or of a part of it: [H, W] of gray, else [H, W, C].

    data: bytes, or what has a buffer. region, scale, size, dtype: as of `Stream.picture`; by default all, in the
    source's size and type. device: what decodes. Raises StreamError for a damaged stream, UsageError for arguments that
    make no sense, RegionError for a region that is not inside the picture.
    """
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
    """The samples of a stream in a file, or of a part of it: [H, W] of gray, else [H, W, C].

    path: a path or a URL; no more of the file is read than the part needs. The other parameters and the errors are
    those of `decode`; StreamError also for a file that cannot be read.
    """
    if not isinstance(path, str | os.PathLike):
        raise UsageError(f"a {type(path).__name__} is no path; decode takes bytes")
    with open_stream(path, device) as stream:
        return stream.read(region, scale, size, dtype)
