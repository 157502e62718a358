"""A level of a stream as an array that is read when it is indexed."""

from __future__ import annotations

import os
from contextlib import suppress
from typing import Any
from uuid import uuid4

import numpy as np
from numpy.typing import DTypeLike, NDArray

from sgicodec.decoder.indexing import indexed_region
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.errors import RegionError

_CHUNK = 1024
"""Pixels along the side of a chunk, about."""


class LevelArray:
    """Samples [H, W] of gray, else [H, W, C]. It can be pickled if its stream was opened by path or from bytes."""

    def __init__(self, stream: Stream, level: int) -> None:
        if not 0 <= level < len(stream.levels):
            raise RegionError(f"level {level}; there are 0 to {len(stream.levels) - 1}")
        self._stream, self._level = stream, level
        self._token = _token(stream)
        found = stream.levels[level]
        self.shape = (found.height, found.width, *stream.shape[2:])
        self.dtype, self.ndim = stream.dtype, stream.ndim

    @property
    def chunks(self) -> tuple[int, ...]:
        """Shape of chunks that follow the borders of tiles: of several small ones, or of one."""
        tile = self._stream.header.tile or _CHUNK
        side = tile * max(1, round(_CHUNK / tile))
        return (min(side, self.shape[0]), min(side, self.shape[1]), *self.shape[2:])

    def __getitem__(self, key: Any) -> NDArray[Any]:
        """Integers and slices; only the region that they touch is decoded."""
        region, inner = indexed_region(key, self.shape)
        if 0 in region[2:]:
            return np.empty((region[3], region[2], *self.shape[2:]), self.dtype)[inner]
        return self._stream.read_level(self._level, region)[inner]

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        samples = self._stream.read_level(self._level)
        return samples if dtype is None else samples.astype(dtype, copy=False)

    def __dask_tokenize__(self) -> tuple[Any, ...]:
        return (*self._token, self._level, self._stream.exact, self._stream.dither)


def level_arrays(source: Any) -> list[LevelArray]:
    """Those of a stream, or of what `sgicodec.open` takes, from the picture down. Raises StreamError."""
    stream = source if isinstance(source, Stream) else open_stream(source)
    return [LevelArray(stream, level) for level in range(len(stream.levels))]


def _token(stream: Stream) -> tuple[Any, ...]:
    """What tells a stream from others: path, size and time of its file; a name of its own of one in memory."""
    if stream.name is not None:
        changed = None
        with suppress(OSError):
            changed = os.stat(stream.name).st_mtime_ns
        return (stream.name, stream.size, changed)
    return (uuid4().hex,)
