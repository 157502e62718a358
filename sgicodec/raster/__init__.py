"""The rasteriser of a fit: back ends with gradients (docs/rasteriser.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer

if TYPE_CHECKING:
    from sgicodec.raster.cuda import CudaRasterizer

__all__ = ["backend_of"]


def backend_of(device: Device, channels: int) -> NativeRasterizer | CudaRasterizer:
    """What draws so many channels: a device's GPU, if it has one and its kernels draw as many, else the processor."""
    if device.gpu is None:
        return NativeRasterizer(device)
    from sgicodec.cuda.gpu import opened
    from sgicodec.cuda.tiles import MAX_CHANNELS
    from sgicodec.raster.cuda import CudaRasterizer

    return NativeRasterizer(device) if channels > MAX_CHANNELS else CudaRasterizer(opened(device.gpu))
