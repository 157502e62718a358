"""Which step computes a fit's loss and gradients."""

from __future__ import annotations

from collections.abc import Sequence

from sgicodec.device import Device
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.fused_step import FusedStep
from sgicodec.fit.parameters import GradientStep
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import FitSettings
from sgicodec.raster.cpu import NativeRasterizer

__all__ = ["gradient_step_of"]


def gradient_step_of(
    spec: ModelSpec,
    settings: FitSettings,
    networks: Sequence[IntNetwork] | None,
    raster: NativeRasterizer,
    size: tuple[int, int],
    family: int,
    device: Device,
) -> GradientStep:
    """The step of this model and loss for a picture of `size` (W, H). networks: of a shipped MLP_p, None for one that
    trains. The paper profile's runs on the GPU that was
    asked for, if its kernels have the model; the default profile's has a whole fit there (`DeviceFit`).

    Raises ValueError for a model or a loss that no profile has.
    """
    if networks is not None and family and settings.loss == "squared" and FusedStep.can_run(spec):
        return FusedStep(spec, settings.seed, networks, raster, device)
    if networks is None and not family and FeatureStep.can_run(spec, settings):
        return _on_gpu(spec, settings, raster, size, device) or FeatureStep(spec, settings, raster, size, device)
    raise ValueError("no step computes this model and loss")


def _on_gpu(
    spec: ModelSpec, settings: FitSettings, raster: NativeRasterizer, size: tuple[int, int], device: Device
) -> FeatureStep | None:
    if device.gpu is None:
        return None
    from sgicodec.cuda.gpu import opened
    from sgicodec.fit.device_feature_step import DeviceFeatureStep

    if not DeviceFeatureStep.can_run(spec, settings):
        return None
    return DeviceFeatureStep(spec, settings, opened(device.gpu), size, raster.cutoff)
