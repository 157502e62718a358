"""Samples of an image on a GPU: what lies behind is added, values are mapped, rounded and interleaved there."""

from __future__ import annotations

from typing import Any

import numpy as np

from sgicodec.cuda import sources
from sgicodec.cuda.gpu import GpuArray
from sgicodec.cuda.structures import structures
from sgicodec.raster.backend import Background, Mapping

__all__ = ["stored_samples"]

THREADS = sources.constants("cuda/raster/samples.hpp")["kSampleThreads"]

_TYPES = {np.dtype(np.uint8): 0, np.dtype(np.uint16): 1, np.dtype(np.float32): 2}
"""As SampleType numbers them (native/base/sample.hpp)."""


def stored_samples(
    image: GpuArray, behind: Background, mapping: Mapping | None, dtype: np.dtype[Any], planes: GpuArray | None = None
) -> GpuArray:
    """Samples [height, width, C] of this type, of an image [C, height, width] on what is behind it. Values as they are
    without a mapping, then of float32. `planes` on the GPU stand for those of `behind`.
    """
    gpu, (channels, height, width) = image.gpu, image.shape
    if mapping is None and dtype != np.float32:
        raise ValueError(f"values are float32, not {dtype}")
    out = gpu.array((height, width, channels), dtype)
    given: dict[str, Any] = {"planes": behind.planes}
    if behind.down.shape[1]:
        given |= {"lines": behind.lines, "top": behind.top, "down": behind.down}
    if mapping is not None:
        given |= {"low": mapping.low, "span": mapping.span}
    held = {name: gpu.put(array) for name, array in given.items() if array is not None}
    if planes is not None:
        held["planes"] = planes
    arguments = structures()["SampleArguments"](
        **{name: array.address for name, array in held.items()},
        **{"image": image.address, "channels": channels, "width": width, "height": height, "out": out.address},
        **{"count": behind.lines.shape[1], "taps": behind.down.shape[1]},
        **{"clip": int(mapping is not None), "type": _TYPES[dtype]},
    )
    gpu.launch("store_samples", -(-width * height // THREADS), THREADS, arguments)
    gpu.wait()  # what is held goes
    return out
