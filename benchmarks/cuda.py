"""Checks and measures the kernels on a GPU: one command for a machine that has one."""

from __future__ import annotations

import ctypes
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any

import click
import numpy as np

from benchmarks._cuda_checks import (
    NotRunError,
    Tuning,
    check_features,
    check_gradients,
    check_images,
    check_repeats,
    check_sanitizer,
    check_streams,
    require,
)
from benchmarks._cuda_floors import H200, Floor, counts_of, floors, peak_of
from benchmarks._cuda_resources import ARCHITECTURES, resources
from benchmarks.raster import Scene
from sgicodec import read
from sgicodec.cuda.choice import device_of
from sgicodec.cuda.compiler import the_compiler
from sgicodec.cuda.gpu import Gpu, opened
from sgicodec.device import Device
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.plan import stream_plan
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.stages import fit, prepare, share
from sgicodec.encoder.tile.state import tile_of
from sgicodec.errors import MissingExtraError, TargetMissedError
from sgicodec.executors.executor import Executor
from sgicodec.executors.processes import ProcessExecutor
from sgicodec.fit.trainer import Progress
from sgicodec.picture import Picture
from sgicodec.raster.cuda import CudaRasterizer

SCENES = (Scene(50_000, 4.0), Scene(500_000, 1.3))
TILE = 256
STEPS = 1000
"""Of the fits and encodes that are timed."""
PICTURE = Path(__file__).parents[1] / "tests" / "data" / "kodim23.png"


def print_tiles(device: Device, picture: Picture, steps: int) -> None:
    """Seconds of an encode in tiles, one tile at a time and several in processes, whose bytes must be the same."""
    settings = EncodeSettings(steps=steps, tile=TILE)
    streams = set()
    for executor in (Executor(), ProcessExecutor(2), ProcessExecutor(device.cores)):
        started = time.monotonic()
        streams.add(encode_picture(picture, settings, executor=executor, device=device).data)
        seconds = time.monotonic() - started
        click.echo(f"tiles of {TILE}, {executor.workers} at a time: {seconds:.2f} s, whole encode")
    require(len(streams) == 1, "tiles at a time change the stream")


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
    """Milliseconds of the passes over a scene."""
    raster, target = CudaRasterizer(gpu), np.zeros((scene.channels, scene.height, scene.width), np.float32)
    for loss in ("squared", "absolute"):
        raster.error(*scene.gaussians(), target, loss)
    assert raster._passes is not None
    passes, held = raster._passes[1], gpu.put(target)
    out = [gpu.array((scene.count, size)) for size in (2, 3, scene.channels)]
    names = ("grad_means", "grad_covariances", "grad_colours")
    fields: dict[str, Any] = {name: array.address for name, array in zip(names, out, strict=True)}
    passes.set(target=held.address, **fields)

    parts = {
        "binning": passes.bin,
        "forward, error, backward": lambda: passes.over_tiles("error"),
        "reduce": passes.reduce,
    }
    return {name: timed(gpu, launch, repeat) for name, launch in parts.items()}


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
        found = resources(the_compiler(), architecture)
        most = [max(column) for column in zip(*found.values(), strict=True)]
        tile = max(needs.registers for name, needs in found.items() if name.startswith("error"))
        click.echo(
            f"sm_{architecture}: {len(found)} kernels in {time.process_time() - started:.1f} s; at most {most[0]} "
            f"registers, {most[1]} bytes shared, {most[2]} spilled; squared error {tile} registers"
        )


def print_times(gpu: Gpu, repeat: int) -> None:
    """Milliseconds of the passes over each scene, and what share of them the device would take at its peak."""
    for scene in SCENES:
        times, peak = measure_scene(gpu, scene, repeat), peak_of(gpu)
        parts: dict[str, Floor] = {part.name: part for part in floors(counts_of(scene))}
        listed = []
        for name, milliseconds in times.items():
            least = sum(parts[part].milliseconds(peak) for part in PARTS.get(name, parts))
            listed.append(f"{name} {milliseconds:.3f} ({100 * least / milliseconds:.0f} %)")
        click.echo(f"{scene.count:,} Gaussians of σ {scene.sigma:g}, ms (share of the peak): {', '.join(listed)}")


PARTS = {
    "binning": ("prepare, list", "sort"),
    "forward, error, backward": ("forward", "backward"),
    "reduce": ("reduce",),
}
"""Whose floors a measured pass has; others have all."""


def print_fit(device: Device, picture: Picture) -> None:
    """Seconds of a fit alone, and of each of its steps."""
    plan = stream_plan(windows_of(picture).shape, EncodeSettings(steps=STEPS, tile=0))
    times = [time.monotonic()]

    class Noting(NullListener):
        def step(self, progress: Progress) -> bool:
            times.append(time.monotonic())
            return True

    tile = tile_of(picture, plan, device, listener=Noting())
    fit(share(prepare(tile)))
    each, steps = 1e3 * median(np.diff(times[1:])), len(times) - 1
    seconds = time.monotonic() - times[0]
    click.echo(f"fit of {picture.width}×{picture.height}: {seconds:.2f} s, {steps} steps of {each:.3f} ms")


def print_large(name: str, picture: str | None) -> None:
    """Seconds of whole processes that encode a large picture to two targets, on the GPU and on the processor."""
    if picture is None:
        click.echo("large: not run: give a picture, such as one of 51 megapixels, with --large")
        return
    with tempfile.TemporaryDirectory() as folder:
        for target, device in product(("31", "36"), (name, "cpu")):
            out, started = Path(folder, f"{target}-{device}.sgi"), time.monotonic()
            command = [sys.executable, "-m", "sgicodec", "encode", picture, str(out), "--psnr", target, "--json"]
            done = subprocess.run([*command, "--device", device], stdout=subprocess.PIPE, text=True)
            require(done.returncode in (0, TargetMissedError.exit_code), f"{' '.join(command)}: {done.returncode}")
            seconds, said = time.monotonic() - started, json.loads(done.stdout)
            size = f"{said['width'] * said['height'] / 1e6:.1f} megapixels in {said['tiles']} tiles"
            reached = f"{said['psnr']:.2f} dB, {said['bytes']:,} bytes"
            click.echo(f"large, {target} dB, {device}: {size}, {seconds:.1f} s, whole process: {reached}")


def print_encodes(device: Device, picture: Picture) -> None:
    """Seconds of an encode, on the GPU and on the processor."""
    settings = EncodeSettings(steps=STEPS)
    for one in (device, Device(device.threads)):
        started = time.monotonic()
        encode_picture(picture, settings, device=one)
        seconds, where = time.monotonic() - started, "processor" if one.gpu is None else "GPU"
        click.echo(f"{picture.width}×{picture.height}, {STEPS} steps, {where}: {seconds:.2f} s, whole encode")


@click.command()
@click.option("--device", "name", default="cuda", show_default=True, help="cuda or cuda:N.")
@click.option("--floors", "only_floors", is_flag=True, help="Only count and print the floors; needs no GPU.")
@click.option("--resources", is_flag=True, help="Only compile for all architectures; needs NVRTC and no GPU.")
@click.option("--kernels-alone", is_flag=True, help="Only what compute-sanitizer runs: each kernel once.")
@click.option("--steps", default=STEPS, show_default=True, help="Steps of the encodes that are compared.")
@click.option("--seeds", default=8, show_default=True, help="How often each crop is encoded.")
@click.option("--repeat", default=20, show_default=True, help="How often each pass is timed.")
@click.option("--large", type=click.Path(exists=True), help="A large picture, encoded to 31 and to 36 dB.")
@click.option("--sanitizer/--no-sanitizer", default=True, show_default=True, help="Run compute-sanitizer.")
@click.option("--picture", default=str(PICTURE), type=click.Path(exists=True), help="What is encoded.")
def main(
    name: str,
    only_floors: bool,
    resources: bool,
    kernels_alone: bool,
    steps: int,
    seeds: int,
    repeat: int,
    large: str | None,
    sanitizer: bool,
    picture: str,
) -> None:
    """Check and time the kernels on a GPU of NVIDIA; without one, say what is missing in one line. A check that could
    not be run makes the exit status 1.
    """
    if only_floors:
        return print_floors()
    if resources:
        return print_resources()
    device = device_of(name)
    if device.gpu is None:
        raise click.UsageError("--device must be cuda or cuda:N")
    gpu = opened(device.gpu)
    click.echo(f"{gpu.name}, NVRTC {the_compiler().version}")
    whole = read(picture)
    click.echo(f"gradients: {check_gradients(gpu)}")
    click.echo(f"paper: {check_features(device, whole.pixels, 6 if kernels_alone else 60)}")
    click.echo(f"images: {check_images(gpu)}")
    if kernels_alone:
        return None
    click.echo(f"repeated: {check_repeats(gpu, SCENES[0])}")
    print_times(gpu, repeat)
    print_fit(device, whole)
    print_encodes(device, whole)
    print_tiles(device, whole, steps)
    for tune in TUNINGS:
        click.echo(f"streams, {tune}: {check_streams(device, whole.pixels, steps, seeds, tune)}")
    print_large(name, large)
    if sanitizer and not run_check("sanitizer", lambda: check_sanitizer(name)):
        sys.exit(1)
    return None


TUNINGS: tuple[Tuning, ...] = ("visual", "psnr")


def run_check(name: str, check: Callable[[], str]) -> bool:
    """Prints what a check says, or that something is missing for it; whether it was run."""
    try:
        click.echo(f"{name}: {check()}")
    except (MissingExtraError, NotRunError) as error:
        click.echo(f"{name}: not run: {error}")
        return False
    return True
