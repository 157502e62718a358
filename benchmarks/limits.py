"""How well time limits are kept and what they give."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from sgicodec.bench.options import numbers

__all__ = ["COLUMNS", "Row", "main", "measured", "numbers_of"]

COLUMNS = ("picture", "asked", "seconds", "steps", "bpp", "psnr", "cost")


@dataclass(frozen=True)
class Row:
    """One command: what it was asked, seconds from its start to its end, what its report says, and J = D + λR for each
    pixel, D over samples in 0..1.
    """

    picture: str
    asked: str
    seconds: float
    steps: int
    bpp: float
    psnr: float
    cost: float

    def line(self) -> str:
        """Tab-separated, in the order of COLUMNS."""
        figures = f"{self.seconds:.1f}\t{self.steps}\t{self.bpp:.4f}\t{self.psnr:.3f}\t{self.cost:.6f}"
        return f"{self.picture}\t{self.asked}\t{figures}"

    @classmethod
    def of(cls, picture: str, asked: str, seconds: float, report: dict[str, Any]) -> Row:
        """From the command's report in JSON."""
        error = report["channel_count"] * 10 ** (-0.1 * report["psnr"])
        cost = error + report["lmbda"] * report["bpp"]
        return cls(picture, asked, seconds, report["steps"], report["bpp"], report["psnr"], cost)


def measured(picture: Path, options: list[str], channels: int) -> Row:
    """Encodes a picture in a process of its own. Raises CalledProcessError if that fails."""
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "out.sgi")
        command = [sys.executable, "-m", "sgicodec", "encode", str(picture), out, *options, "--json", "--quiet"]
        started = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        seconds = time.perf_counter() - started
    report = json.loads(done.stdout) | {"channel_count": channels}
    return Row.of(picture.stem, " ".join(options[:2]), seconds, report)


def numbers_of(text: str, option: str) -> list[str]:
    """Numbers with commas between, as a command takes them. Raises UsageError for what is none."""
    return [f"{number:g}" for number in numbers(text, option)]


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--limits", default="20,60,120", show_default=True, help="Seconds to allow.")
@click.option("--efforts", default="", help="Efforts to set beside them.")
@click.option("--tile", type=int, help="Side of tiles, as in sgi encode.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(pictures: tuple[Path, ...], limits: str, efforts: str, tile: int | None, threads: int) -> None:
    """Encode PICTURES under time limits, each in a process of its own, and print tab-separated rows.

    seconds: of the whole process. steps: mean over the tiles. cost: J = D + λR for each pixel.
    """
    from sgicodec.image import open_source

    asked = [["--time-limit", limit] for limit in numbers_of(limits, "--limits")]
    asked += [["--effort", effort] for effort in numbers_of(efforts, "--efforts")]
    common = ["--threads", f"{threads}"] + (["--tile", f"{tile}"] if tile is not None else [])
    click.echo("\t".join(COLUMNS))
    for picture in pictures:
        with open_source(picture) as source:
            channels = source.header.count
        for options in asked:
            click.echo(measured(picture, [*options, *common], channels).line())
