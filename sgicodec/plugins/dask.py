"""Streams as arrays of Dask: one for each level of the pyramid."""

from __future__ import annotations

from typing import Any

from sgicodec.errors import require
from sgicodec.plugins.level_array import level_arrays


def levels(source: Any, chunks: Any = None) -> list[Any]:
    """Arrays [H, W] of gray, else [H, W, C], of the picture, its half, its quarter … down to 256 pixels.

    source: a stream, or what `sgicodec.open` takes. chunks: as of `dask.array.from_array`, by default about 1024 pixels
    a side, on the borders of tiles. Each chunk decodes what it shows when it is computed. Raises StreamError.
    """
    require("dask", "the plugin for Dask", "arrays")
    from dask import array as dask_array

    from_array: Any = dask_array.from_array  # type: ignore[attr-defined]
    return [from_array(array, chunks or array.chunks, asarray=False) for array in level_arrays(source)]
