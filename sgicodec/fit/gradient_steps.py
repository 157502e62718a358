"""Which step computes a fit's loss and gradients."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sgicodec.device import Device
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.fused_step import FusedStep
from sgicodec.fit.parameters import GradientStep
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import FitSettings
from sgicodec.raster.cpu import NativeRasterizer

if TYPE_CHECKING:
    from sgicodec.raster.cuda import CudaRasterizer

__all__ = ["gradient_step_of"]


def gradient_step_of(
    spec: ModelSpec,
    settings: FitSettings,
    networks: Sequence[IntNetwork] | None,
    raster: NativeRasterizer | CudaRasterizer,
    size: tuple[int, int],
    family: int,
    device: Device,
) -> GradientStep:
    """The step of this model and loss for a picture of `size` (W, H), which `raster` draws. networks: of a shipped
    MLP_p, None for one that trains. Where a GPU draws, it computes all of the paper profile's step.

    Raises ValueError for a model or a loss that no profile has.
    """
    if networks is not None and family and settings.loss == "squared" and FusedStep.can_run(spec):
        return FusedStep(spec, settings.seed, networks, raster, device)
    if networks is None and not family and FeatureStep.can_run(spec, settings):
        if isinstance(raster, NativeRasterizer):
            return FeatureStep(spec, settings, raster, size, device)
        from sgicodec.fit.device_feature_step import DeviceFeatureStep

        return DeviceFeatureStep(spec, settings, raster, size)
    raise ValueError("no step computes this model and loss")
