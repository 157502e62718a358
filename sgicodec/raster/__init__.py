"""The rasteriser: `rasterize` for numpy arrays, and back ends with gradients (docs/rasteriser.md)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import UsageError
from sgicodec.raster.backend import DEFAULT_CUTOFF, Backend
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.reference import ReferenceRasterizer
from sgicodec.raster.rescaling import scaled

if TYPE_CHECKING:
    from sgicodec.raster.cuda import CudaRasterizer

__all__ = [
    "DEFAULT_CUTOFF",
    "Backend",
    "NativeRasterizer",
    "ReferenceRasterizer",
    "backend_of",
    "rasterize",
    "scaled",
]

Gaussians = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]


def rasterize(
    means: ArrayLike,
    covariances: ArrayLike,
    colours: ArrayLike,
    width: int,
    height: int,
    *,
    origin: tuple[int, int] = (0, 0),
    scale: float = 1.0,
    cutoff: float = DEFAULT_CUTOFF,
    backend: Literal["native", "reference"] = "native",
    device: Device = ALL_CORES,
) -> NDArray[np.floating]:
    """Draws I(x) = Σ_i c_i exp(−½ (x − μ_i)ᵀ Σ_i⁻¹ (x − μ_i)) → image [C, height, width] (paper, equations 4 and 5).

    means [N, 2] and covariances [N, 3] (xx, xy, yy) are in pixels and pixels² of the picture at scale 1, colours
    [N, C]. The image is the crop whose first pixel is `origin` (x, y) of the picture scaled by `scale`; pixel (i, j)
    has its centre at (j + ½, i + ½). A scale below 1 filters, so that nothing aliases (`scaled`).
    `native` computes in float32, leaves out what lies beyond `cutoff` standard deviations and runs on `device`, with
    the same result for any number of threads; a GPU draws up to 4 channels. `reference` sums everything in float64.
    Gaussians that are not finite or not positive definite are left out. Raises UsageError for wrong shapes or numbers,
    OverflowError where `native` would need too much memory (`NativeRasterizer`).
    """
    if backend not in ("native", "reference"):
        raise UsageError(f"backend {backend!r}; there are native and reference")
    if width < 1 or height < 1:
        raise UsageError(f"an image of {width}×{height} pixels; it needs at least 1×1")
    for name, value in (("scale", scale), ("cutoff", cutoff)):
        if not (math.isfinite(value) and value > 0):
            raise UsageError(f"a {name} of {value:g}; it must be a positive number")
    gaussians = _arrays(means, covariances, colours, np.float32 if backend == "native" else np.float64)
    if scale != 1:
        gaussians = scaled(*gaussians, (scale, scale))
    channels = gaussians[2].shape[1]
    raster = ReferenceRasterizer() if backend == "reference" else backend_of(device, channels, cutoff)
    image: NDArray[np.floating] = raster.forward(*gaussians, width, height, origin)
    return image


def backend_of(device: Device, channels: int, cutoff: float = DEFAULT_CUTOFF) -> NativeRasterizer | CudaRasterizer:
    """What draws so many channels: a device's GPU, if it has one and its kernels draw as many, else the processor."""
    if device.gpu is None:
        return NativeRasterizer(device, cutoff)
    from sgicodec.cuda.gpu import opened
    from sgicodec.cuda.tiles import MAX_CHANNELS
    from sgicodec.raster.cuda import CudaRasterizer

    if channels > MAX_CHANNELS:
        return NativeRasterizer(device, cutoff)
    return CudaRasterizer(opened(device.gpu), cutoff)


def _arrays(means: ArrayLike, covariances: ArrayLike, colours: ArrayLike, dtype: type[np.floating]) -> Gaussians:
    arrays = tuple(np.ascontiguousarray(values, dtype) for values in (means, covariances, colours))
    shapes = [array.shape for array in arrays]
    count = shapes[0][0]  # ascontiguousarray makes at least one dimension
    if shapes != [(count, 2), (count, 3), (count, shapes[2][-1])] or shapes[2][-1] < 1:
        wrong = ", ".join(str(list(shape)) for shape in shapes)
        raise UsageError(f"means, covariances and colours of shapes {wrong}; they must be [N, 2], [N, 3] and [N, C]")
    return arrays[0], arrays[1], arrays[2]
