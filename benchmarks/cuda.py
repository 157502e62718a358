"""Checks and measures the kernels on a GPU: one command for a machine that has one."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import click
import numpy as np

from benchmarks._cuda_floors import H200, counts_of, floors
from benchmarks.raster import Scene
from sgicodec.cuda.choice import device_of
from sgicodec.cuda.compiler import ARCHITECTURES, the_compiler
from sgicodec.cuda.gpu import Gpu, opened
from sgicodec.cuda.tiles import TilePasses
from sgicodec.decoder.one_call import decode
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import SgiError
from sgicodec.image import read
from sgicodec.metrics.distortion import squared_error
from sgicodec.picture import Picture
from sgicodec.profiles.default import EFFORTS, lmbda_of_quality
from sgicodec.raster.cuda import CudaRasterizer
from sgicodec.raster.reference import ReferenceRasterizer

__all__ = ["main"]

SCENES = (Scene(50_000, 4.0), Scene(500_000, 1.3))
SMALL = Scene(300, 3.0, 150, 100)
PICTURE = Path(__file__).parents[1] / "tests" / "data" / "kodim23.png"
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
    error, found = CudaRasterizer(gpu, cutoff=6.0).squared_error(*scene, target, 1.0)
    means, covariances, colours = (array.astype(np.float64) for array in scene)
    value, expected = ReferenceRasterizer().squared_error(means, covariances, colours, target.astype(np.float64), 1.0)
    apart = max(float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in zip(found, expected, strict=True))
    require(abs(error / value - 1) < 1e-5 and apart < 1e-4, "gradients are not those of the reference")
    return f"{apart:.1e} from the float64 reference"


def check_repeats(gpu: Gpu) -> str:
    """The same bytes from repeated passes over many tiles."""
    scene, size = SCENES[0].gaussians(), SCENES[0]
    target = np.zeros((size.channels, size.height, size.width), np.float32)
    runs = [CudaRasterizer(gpu).squared_error(*scene, target, 1.0) for _ in range(3)]
    same = all(np.array_equal(a, b) for run in runs[1:] for a, b in zip(run[1], runs[0][1], strict=True))
    require(same and len({error for error, _ in runs}) == 1, "repeated passes differ")
    return "equal bytes in three runs"


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


def print_decodes(device: Device, data: bytes, repeat: int) -> None:
    """Median milliseconds of drawing a decoded stream again, and of a whole decode, on the GPU and on the processor."""
    for one in (device, device.processor):
        drawings, decodes = [], []
        for _ in range(repeat):
            started = time.monotonic()
            with open_stream(data, one) as stream:
                stream.picture()
                decodes.append(time.monotonic() - started)
                started = time.monotonic()
                stream.picture()
                drawings.append(time.monotonic() - started)
        where = "processor" if one.gpu is None else "GPU"
        click.echo(f"decode, {where}: {1e3 * median(decodes):.1f} ms, of which {1e3 * median(drawings):.1f} ms draw")


def check_sanitizer() -> str:
    """compute-sanitizer over the checks of gradients: memory, and races in shared memory."""
    command = shutil.which("compute-sanitizer")
    if command is None:
        return "not run: compute-sanitizer is not on the path"
    for tool in ("memcheck", "racecheck", "initcheck", "synccheck"):
        program = [sys.executable, "-m", "benchmarks", "cuda", "--gradients-alone"]
        done = subprocess.run(
            [command, "--tool", tool, "--error-exitcode", "1", *program], capture_output=True, text=True
        )
        require(done.returncode == 0, f"compute-sanitizer {tool}: {done.stdout[-300:]}")
    return "memcheck, racecheck, initcheck and synccheck are clean"


def require(holds: bool, complaint: str) -> None:
    """Raises SgiError unless a check holds."""
    if not holds:
        raise SgiError(complaint)


def timed(gpu: Gpu, launch: Callable[[], None], repeat: int) -> float:
    """Median milliseconds of launches, between events of the GPU."""
    begin, end = (gpu.driver.handle("cuEventCreate", ctypes.c_uint(0)) for _ in range(2))
    times, found = [], ctypes.c_float()
    for _ in range(repeat + 1):
        gpu.driver.call("cuEventRecord", begin, gpu.stream)
        launch()
        gpu.driver.call("cuEventRecord", end, gpu.stream)
        gpu.driver.call("cuEventSynchronize", end)
        gpu.driver.call("cuEventElapsedTime", ctypes.byref(found), begin, end)
        times.append(found.value)
    for event in (begin, end):
        gpu.driver.call("cuEventDestroy_v2", event)
    return median(times[1:])


def measure_scene(gpu: Gpu, scene: Scene, repeat: int) -> dict[str, float]:
    """Milliseconds of the passes over a scene, alone and as one graph."""
    raster, target = CudaRasterizer(gpu), np.zeros((scene.channels, scene.height, scene.width), np.float32)
    raster.squared_error(*scene.gaussians(), target, 1.0)
    assert raster._drawn is not None
    passes, held = raster._drawn[1], gpu.put(target)
    out = [gpu.array((scene.count, size)) for size in (2, 3, scene.channels)]
    names = ("grad_means", "grad_covariances", "grad_colours")
    fields: dict[str, Any] = {name: array.address for name, array in zip(names, out, strict=True)}
    passes.set(target=held.address, **fields)

    def whole() -> None:
        _all(passes)

    with gpu.recorded() as graph:
        whole()
    parts = {
        "binning": passes.bin,
        "forward, error, backward": lambda: passes.over_tiles("squared_error"),
        "reduce": passes.reduce,
        "graph of all": graph.launch,
    }
    return {name: timed(gpu, launch, repeat) for name, launch in parts.items()}


def _all(passes: TilePasses) -> None:
    passes.bin()
    passes.over_tiles("squared_error")
    passes.reduce()


def print_floors() -> None:
    """Counts and floors of the scenes on an H200, without any GPU."""
    click.echo("| Gaussians | σ px | part | Gflop | Gexp | MB | floor µs |\n|---:|---:|---|---:|---:|---:|---:|")
    for scene in SCENES:
        parts = floors(counts_of(scene))
        for part in parts:
            amounts = f"{part.operations / 1e9:.2f} | {part.exponentials / 1e9:.3f} | {part.bytes / 1e6:.0f}"
            click.echo(
                f"| {scene.count:,} | {scene.sigma:g} | {part.name} | {amounts} | {1e3 * part.milliseconds(H200):.0f} |"
            )
        total = sum(part.milliseconds(H200) for part in parts)
        click.echo(f"| {scene.count:,} | {scene.sigma:g} | **all** | | | | **{1e3 * total:.0f}** |")


def print_resources() -> None:
    """Registers and memory of every kernel, by architecture, without any GPU."""
    for architecture in ARCHITECTURES:
        started = time.process_time()
        found = the_compiler().resources(architecture)
        most = [max(column) for column in zip(*found.values(), strict=True)]
        tile = max(needs.registers for name, needs in found.items() if name.startswith("squared_error"))
        click.echo(
            f"sm_{architecture}: {len(found)} kernels in {time.process_time() - started:.1f} s; at most {most[0]} "
            f"registers, {most[1]} bytes shared, {most[2]} spilled; squared error {tile} registers"
        )


def print_times(gpu: Gpu, repeat: int) -> None:
    """Milliseconds of the passes over each scene."""
    for scene in SCENES:
        floor = sum(part.milliseconds(H200) for part in floors(counts_of(scene)))
        times = measure_scene(gpu, scene, repeat)
        listed = ", ".join(f"{part} {milliseconds:.3f}" for part, milliseconds in times.items())
        click.echo(f"{scene.count:,} Gaussians of σ {scene.sigma:g}, ms: {listed}; floor of an H200 {floor:.3f}")


def print_encodes(device: Device, picture: Picture) -> None:
    """Seconds of an encode at the default effort, on the GPU and on the processor."""
    settings = EncodeSettings(steps=EFFORTS[5])
    for one in (device, Device(device.threads)):
        started = time.monotonic()
        encode_picture(picture, settings, device=one)
        seconds, where = time.monotonic() - started, "processor" if one.gpu is None else "GPU"
        click.echo(f"{picture.width}×{picture.height}, {EFFORTS[5]} steps, {where}: {seconds:.2f} s, whole encode")


@click.command()
@click.option("--device", "name", default="cuda", show_default=True, help="cuda or cuda:N.")
@click.option("--floors", "only_floors", is_flag=True, help="Only count and print the floors; needs no GPU.")
@click.option("--resources", is_flag=True, help="Only compile for all architectures; needs NVRTC and no GPU.")
@click.option("--gradients-alone", is_flag=True, help="Only the check that compute-sanitizer runs.")
@click.option("--steps", default=200, show_default=True, help="Steps of the encodes that are compared.")
@click.option("--seeds", default=8, show_default=True, help="How often each crop is encoded.")
@click.option("--repeat", default=20, show_default=True, help="How often each pass is timed.")
@click.option("--picture", default=str(PICTURE), type=click.Path(exists=True), help="What is encoded.")
def main(
    name: str,
    only_floors: bool,
    resources: bool,
    gradients_alone: bool,
    steps: int,
    seeds: int,
    repeat: int,
    picture: str,
) -> None:
    """Check and time the kernels on a GPU of NVIDIA; without one, say what is missing in one line."""
    if only_floors:
        return print_floors()
    if resources:
        return print_resources()
    device = device_of(name)
    if device.gpu is None:
        raise click.UsageError("--device must be cuda or cuda:N")
    gpu = opened(device.gpu)
    click.echo(f"{gpu.name}, NVRTC {the_compiler().version}")
    click.echo(f"gradients: {check_gradients(gpu)}")
    if gradients_alone:
        return None
    click.echo(f"repeated: {check_repeats(gpu)}")
    print_times(gpu, repeat)
    whole = read(picture)
    print_encodes(device, whole)
    for texture in (False, True):
        settings = EncodeSettings(steps=steps, texture=texture)
        data = encode_picture(whole, settings, device=device.processor).data
        click.echo(f"decodes: {check_decodes(device, data)}")
        print_decodes(device, data, repeat)
    click.echo(f"streams: {check_streams(device, whole.pixels, steps, seeds)}")
    click.echo(f"sanitizer: {check_sanitizer()}")
    return None
