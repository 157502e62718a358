"""Seconds of an encode, and its bytes at equal PSNR, next to another version of the package in the same run."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path
from statistics import mean, median

import click

from benchmarks._turns import in_turn
from sgicodec import read
from sgicodec.bench.bdrate import Curve, bd_rate
from sgicodec.bench.sgi import run_timed
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import comparable

__all__ = ["Encode", "Setting", "Version", "main", "rate_changes", "started", "table"]

_CODE = """
import json, sys, time
import numpy, sgicodec

encode = getattr(sgicodec, "encode_picture", sgicodec.encode)
tiny = numpy.zeros((16, 16, 3), numpy.uint8)
encode(sgicodec.Picture(tiny, "rgb", (0.0, 255.0)), sgicodec.EncodeSettings(steps=1))
print(json.dumps("tune" in sgicodec.EncodeSettings.__dataclass_fields__), flush=True)
for line in sys.stdin:
    path, out, settings = json.loads(line)
    picture = sgicodec.read(path)
    start, worked = time.perf_counter(), time.process_time()
    data = encode(picture, sgicodec.EncodeSettings(**settings)).data
    seconds = time.perf_counter() - start, time.process_time() - worked
    with open(out, "wb") as file:
        file.write(data)
    print(json.dumps(seconds), flush=True)
"""
"""Encodes what each line asks for from pixels in memory, after a first encode that loads what all need."""


@dataclass(frozen=True)
class Encode:
    """One encode: seconds by the clock and of all processors from pixels to a stream, seconds of a whole `sgi encode`
    by the clock, and the stream.
    """

    clock: float
    processor: float
    whole: float
    bytes: int
    psnr: float


@dataclass(frozen=True)
class Version:
    """A version of the package: its python, a process of it that waits for work, and whether it can be tuned."""

    python: Path
    process: subprocess.Popen[str]
    tunes: bool

    def encode(self, path: Path, quality: float, effort: int) -> Encode:
        """Encodes towards least squared error, in the process that waits and in a fresh one."""
        settings: dict[str, float | str] = {"quality": quality, "effort": effort}
        settings |= {"tune": "psnr"} if self.tunes else {}
        with tempfile.TemporaryDirectory(prefix="sgi-pace-") as folder:
            out = Path(folder, "out.sgi")
            clock, processor = self._ask(str(path), str(out), settings)
            size, quality_found = out.stat().st_size, _psnr(path, out)
            options = [part for name, value in settings.items() for part in (f"--{name}", str(value))]
            command = [str(self.python), "-m", "sgicodec", "encode", str(path), str(out), "-f", "--no-verify"]
            whole = run_timed([*command, *options]).seconds
        return Encode(clock, processor, whole, size, quality_found)

    def _ask(self, *question: object) -> tuple[float, float]:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps(question), file=self.process.stdin, flush=True)
        clock, processor = json.loads(self.process.stdout.readline())
        return clock, processor


@contextmanager
def started(python: Path) -> Iterator[Version]:
    """The version of the package that this python finds."""
    pipe = subprocess.PIPE
    with subprocess.Popen([str(python), "-I", "-c", _CODE], text=True, stdin=pipe, stdout=pipe) as process:
        assert process.stdout is not None
        yield Version(python, process, json.loads(process.stdout.readline()))
        process.communicate()


Setting = tuple[str, int]
"""Name of a version, effort."""
Runs = Mapping[tuple[Setting, Path, float], Sequence[Encode]]
"""What each setting gave for a picture and a quality, run by run."""


def rate_changes(runs: Runs, anchor: Setting, test: Setting) -> list[float]:
    """Change in bytes at equal PSNR from one setting to another for each picture, in percent."""
    pictures = dict.fromkeys(path for _, path, _ in runs)
    return [bd_rate(_curve(runs, anchor, path), _curve(runs, test, path)).value for path in pictures]


def _curve(runs: Runs, setting: Setting, picture: Path) -> Curve:
    points = [found[0] for (of, path, _), found in runs.items() if (of, path) == (setting, picture)]
    return Curve([point.bytes for point in points], [point.psnr for point in points])


def table(runs: Runs, anchors: Sequence[Setting], megapixels: Mapping[Path, float]) -> list[str]:
    """Rows of Markdown: seconds per megapixel, means over pictures and qualities of medians, and bytes at equal PSNR
    against each anchor, the mean and the most over pictures.
    """
    heads = [f"bytes to {name} `-e {effort}`, % | most" for name, effort in anchors]
    rows = [
        "| version | effort | s per megapixel | of processors | whole process | " + " | ".join(heads) + " |",
        "|---|" + "---:|" * (4 + 2 * len(anchors)),
    ]
    for setting in dict.fromkeys(of for of, _, _ in runs):
        found = [(megapixels[path], some) for (of, path, _), some in runs.items() if of == setting]
        cells = [setting[0], str(setting[1])]
        for kind in ("clock", "processor", "whole"):
            cells.append(f"{mean(median(getattr(run, kind) for run in some) / size for size, some in found):.2f}")
        for anchor in anchors:
            changes = rate_changes(runs, anchor, setting)
            cells += [f"{mean(changes):+.1f}", f"{max(changes):+.1f}"]
        rows.append(f"| {' | '.join(cells)} |")
    return rows


def _psnr(path: Path, stream: Path) -> float:
    with open_stream(stream) as opened:
        return psnr(comparable(read(path)), comparable(opened.picture()))


def _numbers(_: click.Context, __: click.Parameter, value: str) -> tuple[int, ...]:
    return tuple(int(number) for number in value.split(","))


@click.command()
@click.argument("other", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.argument("pictures", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--efforts", default="1,2,3,4,5", show_default=True, callback=_numbers, help="Of this version.")
@click.option("--other-efforts", default="1,5", show_default=True, callback=_numbers, help="Of the other version.")
@click.option("--qualities", default="40,50,60", show_default=True, callback=_numbers)
@click.option("--repeat", default=1, show_default=True, type=click.IntRange(1), help="Runs of each encode.")
def main(
    other: Path,
    pictures: tuple[Path, ...],
    efforts: tuple[int, ...],
    other_efforts: tuple[int, ...],
    qualities: tuple[int, ...],
    repeat: int,
) -> None:
    """Encode PICTURES with this version and with that of the python OTHER, in turn, and print seconds per megapixel
    and bytes at equal PSNR (BD-rate) as Markdown.
    """
    anchors = [("other", effort) for effort in other_efforts]
    settings = [*anchors, *(("this", effort) for effort in efforts)]
    runs: dict[tuple[Setting, Path, float], list[Encode]] = {}
    with started(Path(sys.executable)) as this, started(other) as another:
        versions = {"this": this, "other": another}
        for path, quality in product(pictures, qualities):
            run = partial(_encode, versions, path, quality)
            for setting, found in zip(settings, in_turn(settings, repeat, run), strict=True):
                runs[setting, path, quality] = found
    megapixels = {path: 1e-6 * read(path).width * read(path).height for path in pictures}
    click.echo("\n".join(table(runs, anchors, megapixels)))


def _encode(versions: Mapping[str, Version], path: Path, quality: float, setting: Setting) -> Encode:
    name, effort = setting
    found = versions[name].encode(path, quality, effort)
    click.echo(f"{path.stem} {quality:g} {name} {effort} {found}", err=True)
    return found
