"""What RDOQ minimises besides bits: the error of a model of a picture."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sgicodec._native import WINDOW_PADDING
from sgicodec.arrays import F32, F64
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel, quantise
from sgicodec.device import Device
from sgicodec.model.gaussians import model_gaussians
from sgicodec.model.spec import ModelSpec
from sgicodec.raster.cpu import NativeRasterizer


@dataclass(frozen=True)
class Objective:
    """target [C, H, W]: the picture less its base layer, samples in 0..1, which is what seeds have to show; weights
    [H, W]: what squared errors of seeds count, None where all count the same.
    """

    header: Header
    target: F32
    device: Device
    weights: F32 | None = None

    @cached_property
    def padded_weights(self) -> F32 | None:
        """The weights [H, W + padding] as the native code wants them."""
        return None if self.weights is None else np.pad(self.weights, [(0, 0), (0, WINDOW_PADDING)])

    def gaussians(self, model: TileModel) -> tuple[F32, F32, F32]:
        """Means [N, 2], covariances [N, 3] and colours [N, C] of a model's attributes."""
        return model_gaussians(self.header.spec, joined(model), model.layout, {}, self.device)

    def residual(self, model: TileModel) -> F32:
        """Target less rendered [C, H, W + padding], the last columns zero, as the native code wants it."""
        channels, height, width = self.target.shape
        raster = NativeRasterizer(self.device)
        out = np.zeros((channels, height, width + WINDOW_PADDING), np.float32)
        np.subtract(self.target, raster.forward(*self.gaussians(model), width, height), out=out[:, :, :width])
        return out

    def decoded_residual(self, model: TileModel) -> F32:
        """Target less what a decoder will draw [C, H, W + padding]."""
        return self.residual(with_values(self.header.spec, model, quantise(self.header, model).decoded_values))


def joined(model: TileModel) -> F64:
    """A model's attributes [N, d_A] in coding order."""
    if model.attributes is None:
        raise ValueError("the model has no attributes: it was read, not fitted")
    return np.concatenate(list(model.attributes.values()), axis=1)


def with_values(spec: ModelSpec, model: TileModel, values: F64) -> TileModel:
    """The model with attributes [N, d_A]."""
    groups = {group.name: np.ascontiguousarray(values[:, group.columns]) for group in spec.groups}
    return replace(model, attributes=groups, decoded=None)
