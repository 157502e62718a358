"""What kernels on a GPU must give: each check raises SgiError, or says in a line what it found."""

from __future__ import annotations

import shutil
import subprocess
import sys
from typing import Any

import numpy as np

from benchmarks.raster import Scene
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.cuda.gpu import Gpu
from sgicodec.decoder.one_call import decode
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import SgiError
from sgicodec.fit.trainer import Trainer
from sgicodec.metrics.distortion import squared_error
from sgicodec.model.layout import ROOT_LOG, adaptive_layout, cell_sums
from sgicodec.picture import Picture
from sgicodec.profiles.default import default_settings, default_spec, lmbda_of_quality
from sgicodec.raster.cuda import CudaRasterizer
from sgicodec.raster.reference import ReferenceRasterizer

__all__ = [
    "check_decodes",
    "check_gradients",
    "check_repeats",
    "check_sanitizer",
    "check_seeds",
    "check_streams",
    "require",
]

SMALL = Scene(300, 3.0, 150, 100)
CROP = 256
VIEWS: tuple[dict[str, Any], ...] = (
    {},
    {"region": (3, 5, 17, 11)},
    {"scale": 0.4},
    {"region": (2, 1, 16, 9), "scale": 2.5},
    {"dtype": "uint8"},
)
"""Of the stream whose decodes are compared."""
J_TOLERANCE = 5e-3
"""How far J of fits on a GPU may lie from J of the processor's, beside what chance explains."""


def check_gradients(gpu: Gpu) -> str:
    """Against the float64 reference, relative to their norm."""
    scene = SMALL.gaussians()
    target = np.random.default_rng(1).random((3, SMALL.height, SMALL.width), np.float32)
    raster = CudaRasterizer(gpu, cutoff=6.0)
    error, found = raster.squared_error(*scene, target, 1.0)
    again = raster.backward(*scene, 2 * (raster.forward(*scene, SMALL.width, SMALL.height) - target))
    means, covariances, colours = (array.astype(np.float64) for array in scene)
    value, expected = ReferenceRasterizer().squared_error(means, covariances, colours, target.astype(np.float64), 1.0)
    pairs = (*zip(found, expected, strict=True), *zip(again, expected, strict=True))
    apart = max(float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs)
    require(abs(error / value - 1) < 1e-5 and apart < 1e-4, "gradients are not those of the reference")
    return f"{apart:.1e} from the float64 reference"


def check_repeats(gpu: Gpu, size: Scene) -> str:
    """The same bytes from repeated passes over many tiles."""
    scene = size.gaussians()
    target = np.zeros((size.channels, size.height, size.width), np.float32)
    runs = [CudaRasterizer(gpu).squared_error(*scene, target, 1.0) for _ in range(3)]
    same = all(np.array_equal(a, b) for run in runs[1:] for a, b in zip(run[1], runs[0][1], strict=True))
    require(same and len({error for error, _ in runs}) == 1, "repeated passes differ")
    return "equal bytes in three runs"


def check_seeds(device: Device, pixels: np.ndarray) -> str:
    """What decides which seeds go and come, in the midst of a fit, beside the processor's from the same values."""
    samples = pixels[:CROP, :CROP].transpose(2, 0, 1).astype(np.float32) / np.float32(255) - np.float32(0.5)
    spec, target, lmbda = default_spec(3, prior=3), np.ascontiguousarray(samples), 1e-3
    networks, layout = load_prior(spec), adaptive_layout(target, 30 * lmbda)
    trainer = Trainer(spec, default_settings(lmbda, 60), target, layout, 1, networks, device=device)
    for progress in trainer.iterate():
        if progress.step == 40:
            break
    fit, level = trainer.on_gpu, trainer.levels[0]
    require(fit is not None, "the processor fits")
    assert fit is not None
    energy, lacks = fit.energy(None), fit.residual_sums(level).values[1]
    trainer.fetch()
    drawn = CudaRasterizer(fit.gpu, trainer.raster.cutoff).forward(
        *trainer.seeds.gaussians(), target.shape[2], target.shape[1]
    )
    expected = trainer.seeds.energy(), cell_sums(target - drawn, ROOT_LOG).values[1]
    pairs: list[tuple[np.ndarray, np.ndarray]] = list(zip((energy, lacks), expected, strict=True))
    apart = [float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs]
    require(max(apart) < 1e-4, f"energies and residuals are {apart} from the processor's")
    return f"energies {apart[0]:.1e}, residuals {apart[1]:.1e} from the processor's"


def check_streams(device: Device, pixels: np.ndarray, steps: int, seeds: int) -> str:
    """Encodes of crops: the same bytes twice, CRCs that hold when the processor decodes, J beside the processor's."""
    crops = [pixels[y : y + CROP, x : x + CROP] for y, x in ((0, 0), (pixels.shape[0] - CROP, pixels.shape[1] - CROP))]
    ratios = []
    for number in range(seeds):
        for crop in crops:
            picture = Picture(np.ascontiguousarray(crop), "rgb", (0, 255))
            settings = EncodeSettings(steps=steps, seed=number, tune="psnr")
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


def check_decodes(device: Device, data: bytes) -> str:
    """Views of a stream drawn on the GPU and by the processor: within a level of eight bits, the same bytes again."""
    most = 0
    for view in VIEWS:
        on_gpu, again, on_cpu = (decode(data, device=one, **view) for one in (device, device, device.processor))
        require(np.array_equal(on_gpu, again), "two decodes differ")
        most = max(most, int(np.abs(on_gpu.astype(int) - on_cpu).max()))
    require(most <= 1, f"a pixel is {most} levels from the processor's")
    return f"{len(VIEWS)} views of {len(data):,} bytes at most {most} level from the processor's pixels"


def check_sanitizer() -> str:
    """compute-sanitizer over gradients, steps of a fit, seeds that come and go, and a decode: memory, and races in
    shared memory.
    """
    command = shutil.which("compute-sanitizer")
    if command is None:
        return "not run: compute-sanitizer is not on the path"
    for tool in ("memcheck", "racecheck", "initcheck", "synccheck"):
        program = [sys.executable, "-m", "benchmarks", "cuda", "--kernels-alone"]
        done = subprocess.run(
            [command, "--tool", tool, "--error-exitcode", "1", *program], capture_output=True, text=True
        )
        require(done.returncode == 0, f"compute-sanitizer {tool}: {done.stdout[-300:]}")
    return "memcheck, racecheck, initcheck and synccheck are clean"


def require(holds: bool, complaint: str) -> None:
    """Raises SgiError unless a check holds."""
    if not holds:
        raise SgiError(complaint)
