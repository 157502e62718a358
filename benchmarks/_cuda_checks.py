"""What kernels on a GPU must give: each check raises SgiError, or says in a line what it found."""

from __future__ import annotations

import shutil
import subprocess
import sys
from typing import Literal

import numpy as np

from benchmarks.raster import Scene
from sgicodec.cuda.gpu import Gpu
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import SgiError
from sgicodec.fit.device_feature_step import DeviceFeatureStep
from sgicodec.fit.feature_step import FeatureStep
from sgicodec.fit.trainer import Trainer
from sgicodec.metrics.distortion import squared_error
from sgicodec.model.layout import uniform_layout
from sgicodec.picture import Picture
from sgicodec.profiles.default import lmbda_of_quality
from sgicodec.profiles.paper import paper_settings, paper_spec
from sgicodec.raster.backend import Loss
from sgicodec.raster.cpu import NativeRasterizer
from sgicodec.raster.cuda import CudaRasterizer
from tests.support.reference_raster import ReferenceRasterizer

Tuning = Literal["visual", "psnr"]

SMALL = Scene(300, 3.0, 150, 100)
CROP = 256
CROPS = ((SMALL.width, SMALL.height, (0, 0)), (17, 11, (33, 45)), (64, 32, (-5, 90)))
"""Width, height and origin of what is compared with the processor's samples."""
J_TOLERANCE = 5e-3
"""How far J of fits on a GPU may lie from J of the processor's, beside what chance explains."""


def check_gradients(gpu: Gpu) -> str:
    """Of both losses against the float64 reference, relative to their norm. No sample lies so near to its target that
    rounding turns the sign of what it lacks.
    """
    scene, rng = SMALL.gaussians(), np.random.default_rng(1)
    raster, reference = CudaRasterizer(gpu, cutoff=6.0), ReferenceRasterizer()
    means, covariances, colours = (array.astype(np.float64) for array in scene)
    image = reference.forward(means, covariances, colours, SMALL.width, SMALL.height)
    lacks = rng.uniform(0.1, 1.0, image.shape) * rng.choice((-1.0, 1.0), image.shape)
    target = (image + lacks).astype(np.float32)
    apart = {}
    for loss in _LOSSES:
        errors, found = raster.error(*scene, target, loss)
        values, expected = reference.error(means, covariances, colours, target.astype(np.float64), loss)
        near = all(abs(error / value - 1) < 1e-5 for error, value in zip(errors, values, strict=True))
        apart[loss] = max(_apart(a, b) for a, b in zip(found, expected, strict=True))
        require(near and apart[loss] < 1e-4, f"gradients of {loss} error are not those of the reference")
    return f"{max(apart.values()):.1e} from the float64 reference"


_LOSSES: tuple[Loss, ...] = ("squared", "absolute")


def _apart(found: np.ndarray, expected: np.ndarray) -> float:
    """Relative to the norm of what is expected."""
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def _samples(pixels: np.ndarray) -> np.ndarray:
    """Of a crop [3, H, W], around zero."""
    samples = pixels[:CROP, :CROP].transpose(2, 0, 1).astype(np.float32) / np.float32(255) - np.float32(0.5)
    return np.ascontiguousarray(samples)


def check_repeats(gpu: Gpu, size: Scene) -> str:
    """The same bytes from repeated passes over many tiles."""
    scene = size.gaussians()
    target = np.zeros((size.channels, size.height, size.width), np.float32)
    runs = [CudaRasterizer(gpu).error(*scene, target) for _ in range(3)]
    same = all(np.array_equal(a, b) for run in runs[1:] for a, b in zip(run[1], runs[0][1], strict=True))
    require(same and len({error for error, _ in runs}) == 1, "repeated passes differ")
    return "equal bytes in three runs"


def check_features(device: Device, pixels: np.ndarray, number: int = 60) -> str:
    """A step of the paper profile under noise, with a price on bits, beside the processor's from the same values: those
    that a fit has at step `number`.
    """
    spec, target = paper_spec(3, per_seed=3, features=9), _samples(pixels)
    settings, size = paper_settings(_FEATURE_RATE, 1, 100), (target.shape[2], target.shape[1])
    layout = uniform_layout(*size, 300, np.random.default_rng(1))
    trainer = Trainer(spec, settings, target, layout, device=device)
    for progress in trainer.iterate():
        if progress.step == number:
            break
    raster, on_gpu = NativeRasterizer(device, cutoff=6.0), trainer.gradient_step
    require(isinstance(on_gpu, DeviceFeatureStep), "the processor fits")
    assert isinstance(on_gpu, DeviceFeatureStep)
    far = CudaRasterizer(on_gpu.gpu, cutoff=6.0)
    steps = DeviceFeatureStep(spec, settings, far, size), FeatureStep(spec, settings, raster, size, device)
    results = []
    for step in steps:
        step.set_layout(layout, trainer.colour_step)
        results.append(step.run(trainer.parameters, "noise", number, trainer.levels[0], _FEATURE_RATE))
    found, expected = results
    apart = {name: _apart(found.gradients[name], want) for name, want in expected.gradients.items()}
    near = abs(found.error / expected.error - 1) < 1e-4 and abs(found.bits / expected.bits - 1) < 1e-4
    require(near and max(apart.values()) < _FEATURE_TOLERANCE, f"gradients are {apart} from the processor's")
    return f"{max(apart.values()):.1e} from the processor's"


_FEATURE_RATE = 0.02
"""λ of a step of the paper profile in which bits weigh."""
_FEATURE_TOLERANCE = 5e-3
"""Of gradients: that of an absolute error jumps where a sample meets its target."""


def check_streams(device: Device, pixels: np.ndarray, steps: int, seeds: int, tune: Tuning) -> str:
    """Encodes of crops: the same bytes twice, CRCs that hold when the processor decodes, J beside the processor's."""
    crops = [pixels[y : y + CROP, x : x + CROP] for y, x in ((0, 0), (pixels.shape[0] - CROP, pixels.shape[1] - CROP))]
    ratios = []
    for number in range(seeds):
        for crop in crops:
            picture = Picture(np.ascontiguousarray(crop), "rgb", (0, 255))
            settings = EncodeSettings(steps=steps, seed=number, tune=tune)
            on_gpu, again, on_cpu = (
                encode_picture(picture, settings, device=one).data for one in (device, device, Device(device.threads))
            )
            require(on_gpu == again, "two encodes differ")
            ratios.append(cost(picture, on_gpu) / cost(picture, on_cpu))
    mean, spread = float(np.mean(ratios)), float(np.std(ratios) / max(1, len(ratios) - 1) ** 0.5)
    require(abs(mean - 1) < J_TOLERANCE + 2 * spread, f"J is {mean:.4f} of the processor's")
    return (
        f"equal bytes twice; J {100 * (mean - 1):+.2f} ± {100 * spread:.2f} % to the processor's, {len(ratios)} encodes"
    )


def cost(picture: Picture, data: bytes) -> float:
    """J = D + λR of a stream at the default quality; reading it checks the CRCs of its symbols."""
    with open_stream(data) as stream:
        return squared_error(picture, stream.picture()) + lmbda_of_quality(50) * 8 * len(data)


def check_images(gpu: Gpu) -> str:
    """Crops of a scene on the GPU and by the processor: the same samples."""
    scene = SMALL.gaussians()
    for width, height, origin in CROPS:
        rasters = CudaRasterizer(gpu), NativeRasterizer()
        found, expected = (raster.forward(*scene, width, height, origin) for raster in rasters)
        require(np.array_equal(found, expected), f"samples of a crop at {origin} are not the processor's")
    return f"{len(CROPS)} crops have the processor's samples"


def check_sanitizer(name: str) -> str:
    """compute-sanitizer over gradients, images and steps of a fit on the device of this name: memory, and races in
    shared memory. Raises NotRunError where there is none.
    """
    command = shutil.which("compute-sanitizer")
    if command is None:
        raise NotRunError("compute-sanitizer is not on the path")
    for tool in ("memcheck", "racecheck", "initcheck", "synccheck"):
        program = [sys.executable, "-m", "benchmarks", "cuda", "--kernels-alone", "--device", name]
        done = subprocess.run(
            [command, "--tool", tool, "--error-exitcode", "1", *program], capture_output=True, text=True
        )
        require(done.returncode == 0, f"compute-sanitizer {tool}: {done.stdout[-300:]}")
    return "memcheck, racecheck, initcheck and synccheck are clean"


class NotRunError(SgiError):
    """A check for which something is missing."""


def require(holds: bool, complaint: str) -> None:
    """Raises SgiError unless a check holds."""
    if not holds:
        raise SgiError(complaint)
