"""Where the time of a decode goes, from an open file to pixels (`python -m benchmarks.latency FILE.sgi`)."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import Any

import click
import numpy as np

from benchmarks.raster import forward_operations, pairs_within
from sgicodec import _native
from sgicodec.bench.sgi import run_timed
from sgicodec.bitstream.parts import attributes
from sgicodec.bitstream.parts.tile import read_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.raster import DEFAULT_CUTOFF, NativeRasterizer

__all__ = ["STAGES", "Breakdown", "Work", "cold_times", "main", "measure", "stage_times"]

STAGES: dict[str, tuple[str, ...]] = {
    "file, chunks, header": ("decoder.stream:open_stream",),
    "quadtree, with its flags": ("bitstream.parts.tile:_code_layout",),
    "weights and steps": ("bitstream.parts.tile:code_networks", "bitstream.parts.tile:_code_plan"),
    "neighbours, as far as waited for": (),
    "MLP_p with inputs, steps and values": (),
    "symbols of attributes and small arrays": (
        "bitstream.parts.tile:SymbolReader.code",
        "bitstream.parts.tile:SymbolReader.code_bits",
    ),
    "passes, and memory for them": ("bitstream.parts.attributes:AttributeCoder.code",),
    "Gaussians": ("decoder.tile_renderer:_drawable",),
    "base layer": ("bitstream.parts.tile:_code_base_layer", "decoder.tile_renderer:base_view"),
    "drawing, background, rounding": ("decoder.tile_renderer:NativeRasterizer.draw",),
    "the rest": ("decoder.stream:Stream.picture",),
}
"""What is called what: functions by module, each with the time that it spends outside of those of other stages."""

_NATIVE = (
    "neighbours, as far as waited for",
    "MLP_p with inputs, steps and values",
    "symbols of attributes and small arrays",
)
"""The stages whose seconds `read_attributes` tells."""


@dataclass(frozen=True)
class Breakdown:
    """Seconds of a whole decode, medians and minimum, and median seconds of each stage."""

    total: float
    least: float
    stages: dict[str, float]


@dataclass(frozen=True)
class Work:
    """What a decode cannot do without: symbols, and seconds of the range decoder for them; multiply-adds of MLP_p,
    Gaussians times pixels within the cutoff, and bytes of the stream and of the samples.
    """

    symbols: int
    range_decoder: float
    network: int
    pairs: int
    stream_bytes: int
    sample_bytes: int

    @classmethod
    def of(cls, stream: Stream) -> Work:
        """That of a stream of a single tile, which is decoded for it."""
        header, tile = stream.header, stream.tile(0)
        payload = decode_tile_chunk(header, stream.payload(0)).model or b""
        model, walk = read_tile(header, payload)
        seconds = min(read_tile(header, payload)[1].seconds for _ in range(5))
        per_seed = sum(net.w1.size + net.w2.size for net in model.networks)
        means, covariances, colours = tile.gaussians
        pairs = pairs_within((means, covariances, colours), DEFAULT_CUTOFF, header.width, header.height)
        samples = header.width * header.height * header.spec.channels * np.dtype(header.sample_type).itemsize
        return cls(walk.count, seconds, per_seed * len(model.layout), pairs, stream.size, samples)


@contextmanager
def stage_times() -> Iterator[dict[str, float]]:
    """Seconds of each stage inside the block, by wrapping the functions of STAGES: a microsecond for every call."""
    spent: dict[str, float] = defaultdict(float)
    inner: list[float] = []
    undo: list[tuple[Any, str, Any]] = []
    for label, paths in STAGES.items():
        for path in paths:
            owner, name = _resolve(path)
            undo.append((owner, name, getattr(owner, name)))
            setattr(owner, name, _timed(getattr(owner, name), label, spent, inner))
    undo.append((attributes, "read_attributes", attributes.read_attributes))
    attributes.read_attributes = _told(attributes.read_attributes, spent, inner)  # type: ignore[assignment]
    try:
        yield spent
    finally:
        for owner, name, function in reversed(undo):
            setattr(owner, name, function)


def _resolve(path: str) -> tuple[Any, str]:
    module, _, names = path.partition(":")
    owner: Any = import_module(f"sgicodec.{module}")
    *classes, name = names.split(".")
    for part in classes:
        owner = getattr(owner, part)
    return owner, name


def _timed(function: Callable[..., Any], label: str, spent: dict[str, float], inner: list[float]) -> Callable[..., Any]:
    @wraps(function)
    def wrapper(*args: Any, **kwargs: Any) -> Any:
        inner.append(0.0)
        start = time.perf_counter()
        try:
            return function(*args, **kwargs)
        finally:
            seconds = time.perf_counter() - start
            spent[label] += seconds - inner.pop()
            if inner:
                inner[-1] += seconds

    return wrapper


def _told(function: Callable[..., Any], spent: dict[str, float], inner: list[float]) -> Callable[..., Any]:
    @wraps(function)
    def wrapper(*args: Any, **kwargs: Any) -> Any:
        result = function(*args, **kwargs)
        for label, seconds in zip(_NATIVE, result[-1], strict=True):
            spent[label] += seconds
            inner[-1] += seconds
        return result

    return wrapper


def measure(path: Path, threads: int, isa: str = "auto", repeat: int = 25) -> Breakdown:
    """Opens and decodes a file `repeat` times in this process, after once to find memory."""
    open_stream(path, isa).picture(threads=threads)
    totals, stages = [], []
    for _ in range(repeat):
        with stage_times() as spent:
            decoder = import_module("sgicodec.decoder.stream")
            start = time.perf_counter()
            with decoder.open_stream(path, isa) as stream:
                stream.picture(threads=threads)
            totals.append(time.perf_counter() - start)
        stages.append(dict(spent))
    shares = {label: median(run.get(label, 0.0) for run in stages) for label in STAGES}
    return Breakdown(median(totals), min(totals), shares)


def cold_times(path: Path, threads: int, isa: str = "auto", repeat: int = 7) -> dict[str, float]:
    """Median seconds in fresh processes: import of the decoder, the first decode, and the command with PNG output."""
    code = (
        "import sys, time; start = time.perf_counter(); from sgicodec import open_stream; open_stream; "
        "loaded = time.perf_counter(); open_stream(sys.argv[1], sys.argv[3]).picture(threads=int(sys.argv[2])); "
        "print(loaded - start, time.perf_counter() - loaded)"
    )
    fresh = [sys.executable, "-c", code, str(path), str(threads), isa]
    runs = [subprocess.run(fresh, capture_output=True, text=True, check=True).stdout.split() for _ in range(repeat)]
    with tempfile.TemporaryDirectory(prefix="sgi-latency-") as folder:
        decode = [sys.executable, "-m", "sgicodec", "decode", str(path), "-f", "-j", str(threads)]
        png = [run_timed([*decode, str(Path(folder, "out.png"))]) for _ in range(repeat)]
    return {
        "import of the decoder, numpy included": median(float(run[0]) for run in runs),
        "first decode, open file to pixels": median(float(run[1]) for run in runs),
        "`sgi decode` to PNG, the whole process": median(run.seconds for run in png),
    }


def floors(work: Work, breakdown: Breakdown, channels: int, threads: int, isa: str) -> dict[str, float]:
    """Least seconds of the stages whose work can be counted: see docs/speed.md."""
    peak = _native.fma_peak(threads, isa)
    block = np.ones(work.sample_bytes, np.uint8)
    copies = []
    for _ in range(5):
        start = time.perf_counter()
        block.copy()
        copies.append(time.perf_counter() - start)
    return {
        "symbols of attributes and small arrays": work.range_decoder,
        "MLP_p with inputs, steps and values": work.network
        / peak,  # two 16-bit products where it counts one of 32 bits
        "drawing, background, rounding": work.pairs * forward_operations(channels) / peak + min(copies),
    }


@click.command()
@click.argument("path", type=click.Path(path_type=Path, exists=True, dir_okay=False), metavar="FILE.sgi")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(1))
@click.option("--isa", default="auto", show_default=True, type=click.Choice(["auto", "avx512", "avx2", "portable"]))
@click.option("--repeat", default=25, show_default=True, type=click.IntRange(1), help="Runs; medians are printed.")
@click.option("--cold/--no-cold", default=True, show_default=True, help="Also time fresh processes.")
def main(path: Path, threads: int, isa: str, repeat: int, cold: bool) -> None:
    """Time the decoding of FILE.sgi stage by stage."""
    try:
        name = NativeRasterizer(threads, isa).isa
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    with open_stream(path, isa) as stream:
        header, work = stream.header, Work.of(stream)
        gaussians = len(stream.model.layout) * header.spec.per_seed
    breakdown = measure(path, threads, isa, repeat)
    least = floors(work, breakdown, header.spec.channels, threads, isa)
    workers = "1 thread" if threads == 1 else f"{threads} threads"
    click.echo(f"{header.width}×{header.height} pixels, {gaussians:,} Gaussians, {work.stream_bytes:,} bytes")
    click.echo(f"{work.symbols:,} symbols, {work.network / 1e6:.0f} M multiply-adds of MLP_p, ", nl=False)
    click.echo(f"{work.pairs / 1e6:.1f} M pairs of Gaussian and pixel, {work.sample_bytes / 1e6:.1f} MB of samples")
    click.echo(f"{name}, {workers}, median of {repeat} runs\n\n| stage | ms | floor ms |\n|---|---:|---:|")
    for label, seconds in breakdown.stages.items():
        floor = f"{1e3 * least[label]:.1f}" if label in least else ""
        click.echo(f"| {label} | {1e3 * seconds:.1f} | {floor} |")
    click.echo(f"| **open file to pixels** | **{1e3 * breakdown.total:.1f}** | {1e3 * sum(least.values()):.1f} |")
    click.echo(f"| fastest run | {1e3 * breakdown.least:.1f} | |")
    if cold:
        for label, seconds in cold_times(path, threads, isa).items():
            click.echo(f"| {label} | {1e3 * seconds:.0f} | |")


if __name__ == "__main__":
    main()
