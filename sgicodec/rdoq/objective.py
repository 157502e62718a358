"""What RDOQ minimises besides bits: the error of a model of a picture."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sgicodec._native import WINDOW_PADDING
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel, quantise
from sgicodec.device import Device
from sgicodec.model.base import base_colours, render_base
from sgicodec.model.gaussians import model_gaussians
from sgicodec.model.spec import ModelSpec
from sgicodec.raster.cpu import NativeRasterizer

__all__ = ["Objective", "can_optimise", "joined", "with_values"]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def can_optimise(spec: ModelSpec) -> bool:
    """Whether RDOQ knows this kind of model: one Gaussian per seed, rendered as its colour, shape and offset say and
    coded in three steps from what neighbours say.
    """
    return spec.plain


@dataclass(frozen=True)
class Objective:
    """picture [C, H, W]: samples in 0..1; weights [H, W]: what squared errors of seeds count, None where all count the
    same.
    """

    header: Header
    picture: F32
    device: Device
    weights: F32 | None = None

    @cached_property
    def padded_weights(self) -> F32 | None:
        """The weights [H, W + padding] as the native code wants them."""
        return None if self.weights is None else np.pad(self.weights, [(0, 0), (0, WINDOW_PADDING)])

    def target(self, model: TileModel) -> F32:
        """The picture less a model's base layer [C, H, W]: what its seeds have to show."""
        return self.picture - self._base(model)

    def _base(self, model: TileModel) -> F32:
        _, height, width = self.picture.shape
        if not model.base.size:
            return np.zeros_like(self.picture)
        colours = base_colours(model.base, model.base_step)
        return render_base(colours, self.header.spec.base_cell, np.arange(width) + 0.5, np.arange(height) + 0.5)

    def gaussians(self, model: TileModel) -> tuple[F32, F32, F32]:
        """Means [N, 2], covariances [N, 3] and colours [N, C] of a model's attributes."""
        return model_gaussians(self.header.spec, joined(model), model.layout, {}, self.device)

    def residual(self, model: TileModel) -> F32:
        """Target less rendered [C, H, W + padding], the last columns zero, as the native code wants it."""
        _, height, width = self.picture.shape
        raster = NativeRasterizer(self.device)
        out = np.zeros((*self.picture.shape[:2], width + WINDOW_PADDING), np.float32)
        np.subtract(self.target(model), raster.forward(*self.gaussians(model), width, height), out=out[:, :, :width])
        return out

    def decoded_residual(self, model: TileModel) -> F32:
        """Target less what a decoder will draw [C, H, W + padding]."""
        return self.residual(with_values(self.header.spec, model, quantise(self.header, model).values))


def joined(model: TileModel) -> F64:
    """A model's attributes [N, d_A] in coding order."""
    if model.attributes is None:
        raise ValueError("the model has no attributes: it was read, not fitted")
    return np.concatenate(list(model.attributes.values()), axis=1)


def with_values(spec: ModelSpec, model: TileModel, values: F64) -> TileModel:
    """The model with attributes [N, d_A]."""
    groups = {group.name: np.ascontiguousarray(values[:, group.columns]) for group in spec.groups}
    return replace(model, attributes=groups, decoded=None)
