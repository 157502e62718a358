"""Scenes for the rasteriser's tests, and what their errors are measured in."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from reference_raster import rasterize_reference

from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Scene = tuple[F32, F32, F32]


def available(isa: str) -> bool:
    try:
        return NativeRasterizer(Device(isa=isa)).isa == isa
    except ValueError:
        return False


ISAS = [isa for isa in ("avx512", "avx2", "portable") if available(isa)]


def covariances_of(sigma: F64, ratio: F64, angle: F64) -> F64:
    """Covariances [N, 3] of ellipses with deviations sigma·ratio along `angle` (from the x axis) and sigma across."""
    along, across = (sigma * ratio) ** 2, sigma**2
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack(
        [cos**2 * along + sin**2 * across, cos * sin * (along - across), sin**2 * along + cos**2 * across], axis=1
    )


def random_scene(
    rng: np.random.Generator,
    count: int,
    channels: int,
    width: int,
    height: int,
    sigma: tuple[float, float] = (0.3, 20.0),
    ratio: float = 1.0,
    margin: float = 40.0,
) -> Scene:
    """Gaussians of the shorter deviations `sigma`, up to `ratio` times as long, up to `margin` pixels outside."""
    means = rng.uniform([-margin, -margin], [width + margin, height + margin], (count, 2))
    short = np.exp(rng.uniform(*np.log(sigma), count))
    shapes = covariances_of(short, np.exp(rng.uniform(0, np.log(ratio), count)), rng.uniform(0, np.pi, count))
    colours = rng.normal(size=(count, channels))
    return means.astype(np.float32), shapes.astype(np.float32), colours.astype(np.float32)


def exact(scene: Scene) -> tuple[F64, F64, F64]:
    means, covariances, colours = (array.astype(np.float64) for array in scene)
    return means, covariances, colours


def backward(raster: Any, scene: Scene, grad: F32, origin: tuple[int, int] = (0, 0)) -> tuple[F32, ...]:
    """Gradients from dL/dI = grad [C, H, W]: those of squared error to a target that lies grad / 2 below the image."""
    _, height, width = grad.shape
    return raster.error(*scene, raster.forward(*scene, width, height, origin) - grad / 2, origin=origin)[1]


def magnitude(scene: Scene, width: int, height: int, origin: tuple[int, int] = (0, 0)) -> F64:
    """Σ |c| G [C, H, W]: what rounding errors of an image are relative to."""
    means, covariances, colours = exact(scene)
    return rasterize_reference(means, covariances, np.abs(colours), width, height, origin)


def values_of(scene: Scene, width: int, height: int, origin: tuple[int, int] = (0, 0)) -> F64:
    """G of every Gaussian [N, H, W]."""
    means, covariances, _ = exact(scene)
    return rasterize_reference(means, covariances, np.eye(len(means)), width, height, origin)


def whitened(scene: Scene, gradients: tuple[NDArray[np.floating], ...]) -> F64:
    """Gradients in each Gaussian's own units [N, 5 + C]: Lᵀ dL/dμ, Lᵀ (dL/dΣ) L with Σ = L Lᵀ, and dL/dc."""
    _, covariances, _ = exact(scene)
    by_mean, by_covariance, by_colour = (gradient.astype(np.float64) for gradient in gradients)
    factor = np.linalg.cholesky(covariances[:, [0, 1, 1, 2]].reshape(-1, 2, 2))
    moved = np.einsum("nji,nj->ni", factor, by_mean)
    matrix = (by_covariance * [1, 0.5, 1])[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    bent = np.einsum("nji,njk,nkl->nil", factor, matrix, factor).reshape(-1, 4)[:, [0, 1, 3]]
    return np.concatenate([moved, bent, by_colour], axis=1)


def gradient_magnitude(scene: Scene, grad: F32, origin: tuple[int, int] = (0, 0)) -> F64:
    """Σ |<dL/dI, c>| G and Σ |dL/dI| G [N, 5 + C]: what rounding errors of whitened gradients are relative to."""
    values = values_of(scene, grad.shape[2], grad.shape[1], origin)
    weight = np.abs(np.tensordot(scene[2].astype(np.float64), grad.astype(np.float64), axes=1))
    inner = np.sum(weight * values, axis=(1, 2))[:, None]
    return np.concatenate([inner.repeat(5, axis=1), np.tensordot(values, np.abs(grad), axes=([1, 2], [1, 2]))], axis=1)
