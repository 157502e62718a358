"""Texture on a GPU, from the tables that the decoder makes (native/model/texture_tables.hpp)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.structures import structures

__all__ = ["TextureTables", "drawn_texture"]

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

THREADS = sources.constants("cuda/raster/texture.hpp")["kTextureThreads"]


class TextureTables(NamedTuple):
    """As in C++, arrays of one axis. mix: [9], or None."""

    amplitudes: F32
    across: F32
    down: F32
    cells: I32
    start: I32
    shown: I32
    blocks_across: int
    mix: F32 | None


def drawn_texture(gpu: Gpu, tables: TextureTables, shape: tuple[int, int, int]) -> GpuArray:
    """Planes [C, height, width] of this shape."""
    channels, height, width = shape
    planes = gpu.array(shape)
    held = {name: gpu.put(array) for name, array in tables._asdict().items() if isinstance(array, np.ndarray)}
    given = structures()["TextureArguments"](
        **{name: array.address for name, array in held.items()},
        **{"planes": planes.address, "blocks_across": tables.blocks_across},
        **{"channels": channels, "height": height, "width": width},
    )
    gpu.launch("draw_cells", len(tables.start) - 1, THREADS, given)
    gpu.wait()  # what is held goes
    return planes
