"""Seconds to encode and to decode pictures, in this process and from the start of a fresh one."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import click
import numpy as np

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.bench.sgi import run_timed
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import comparable

__all__ = ["Speed", "fresh_decode", "main", "measure"]

_FRESH = """
import sys, time
start = time.perf_counter()
from sgicodec import Device
from sgicodec.decoder.stream import open_stream
loaded = time.perf_counter()
with open_stream(sys.argv[1], Device(int(sys.argv[2]))) as stream:
    stream.picture()
print(loaded - start, time.perf_counter() - loaded)
"""


@dataclass(frozen=True)
class Speed:
    """One picture at one quality. encode, encode_cpu: seconds by the clock and of all processors; decode: seconds from
    bytes to pixels, median; psnr in dB.
    """

    encode: float
    encode_cpu: float
    decode: float
    bytes: int
    psnr: float


def measure(path: Path, settings: EncodeSettings, device: Device, repeat: int) -> tuple[Speed, bytes]:
    """Encodes a picture once and decodes it `repeat` times, after once to find memory; the stream beside."""
    picture = read(path)
    started, worked = time.perf_counter(), time.process_time()
    data = encode_picture(picture, settings, device=device).data
    encoded, cpu = time.perf_counter() - started, time.process_time() - worked
    seconds = []
    for _ in range(repeat + 1):
        started = time.perf_counter()
        with open_stream(data, device) as stream:
            decoded = stream.picture()
        seconds.append(time.perf_counter() - started)
    quality = psnr(comparable(picture), comparable(decoded))
    return Speed(encoded, cpu, median(seconds[1:]), len(data), quality), data


def fresh_decode(data: bytes, threads: int, repeat: int) -> dict[str, float]:
    """Median seconds in fresh processes: import of the decoder, first decode, and `sgi decode` to a PNG."""
    with tempfile.TemporaryDirectory(prefix="sgi-speed-") as folder:
        path = Path(folder, "in.sgi")
        path.write_bytes(data)
        library = [sys.executable, "-c", _FRESH, str(path), str(threads)]
        command = [sys.executable, "-m", "sgicodec", "decode", str(path), str(Path(folder, "out.png")), "-f"]
        runs = [subprocess.run(library, capture_output=True, text=True, check=True).stdout for _ in range(repeat)]
        whole = [run_timed([*command, "-j", str(threads)]).seconds for _ in range(repeat)]
    imported, first = zip(*(map(float, run.split()) for run in runs), strict=True)
    return {"import": median(imported), "first decode": median(first), "sgi decode to PNG": median(whole)}


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--quality", default=50.0, show_default=True, type=click.FloatRange(1, 100))
@click.option("--effort", default=EncodeSettings.effort, show_default=True, type=click.IntRange(1, 9))
@click.option("--steps", type=click.IntRange(1), help="Steps of the fit, instead of what the effort says.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(1))
@click.option("--repeat", default=15, show_default=True, type=click.IntRange(1), help="Decodes; medians are printed.")
@click.option("--fresh", default=3, show_default=True, type=click.IntRange(0), help="Fresh processes; 0 for none.")
def main(
    pictures: tuple[Path, ...], quality: float, effort: int, steps: int | None, threads: int, repeat: int, fresh: int
) -> None:
    """Encode and decode PICTURES, and print seconds as Markdown rows."""
    tiny = Picture(np.zeros((16, 16, 1), np.uint8), "gray", (0.0, 255.0))
    encode_picture(tiny, EncodeSettings(steps=1))  # the first encode loads what all need
    click.echo("| picture | encode s | of processors | decode ms | import ms | first decode ms | sgi decode ms |")
    click.echo("|---|" + "---:|" * 6)
    for path in pictures:
        settings = EncodeSettings(quality=quality, effort=effort, steps=steps)
        speed, data = measure(path, settings, Device(threads), repeat)
        cold = fresh_decode(data, threads, fresh).values() if fresh else ()
        cells = [path.stem, f"{speed.encode:.2f}", f"{speed.encode_cpu:.2f}", f"{1e3 * speed.decode:.1f}"]
        click.echo("| " + " | ".join([*cells, *(f"{1e3 * seconds:.0f}" for seconds in cold)]) + " |")
