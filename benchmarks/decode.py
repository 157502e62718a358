"""What decoding costs, next to another version of the package in the same run"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import TypeVar

import click

from benchmarks._turns import against, in_turn

Found = TypeVar("Found")

CASES = Path(__file__).with_name("_decode_cases.py")

ISOLATED = ("-I",)
"""Each Python takes the package of its own environment, whatever lies in this folder."""

STARTS = {
    "start of Python": ("-c", "pass"),
    "import sgicodec; sgicodec.decode": ("-c", "import sgicodec; sgicodec.decode"),
    "fresh process, whole picture": ("-c", "import sys, sgicodec; sgicodec.imread(sys.argv[1])"),
    "sgi decode to PNG": ("-m", "sgicodec", "decode", "-f", "-o", "OUT"),
}
"""What a Python does with a stream, whose path follows."""


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, dir_okay=False))
@against
@click.option("--threads", default=1, show_default=True, type=click.IntRange(1))
@click.option("--repeat", default=9, show_default=True, type=click.IntRange(1), help="Processes, which take turns.")
def main(paths: tuple[Path, ...], against: Path | None, threads: int, repeat: int) -> None:
    """Print for each stream milliseconds of starts (median of the clock) and of decodes in a running process (least of
    the processor, or the median of the clock, of the quickest process); with --against, those of the other version and
    the ratio.
    """
    pythons = [Path(sys.executable), *([] if against is None else [against])]
    for path in paths:
        click.echo(f"{path}\n")
        click.echo("| | ms |" + " other, ms | ratio |" * (against is not None))
        click.echo("|---|---:|" + "---:|---:|" * (against is not None))
        _print_starts(path, pythons, repeat)
        _print_decodes(path, pythons, repeat, threads)
        click.echo()


def _print_starts(path: Path, pythons: list[Path], repeat: int) -> None:
    with tempfile.TemporaryDirectory(prefix="sgi-decode-") as folder:
        for name, arguments in STARTS.items():
            command = *(part.replace("OUT", str(Path(folder, "out.png"))) for part in arguments), str(path)
            runs = in_turn(pythons, repeat, partial(_seconds, command))
            _print(name, [statistics.median(of_one) for of_one in runs])


def _print_decodes(path: Path, pythons: list[Path], repeat: int, threads: int) -> None:
    decodes = in_turn(pythons, repeat, partial(_cases, path, threads))
    for name in decodes[0][0]:
        _print(name, [min(run[name] for run in of_one) for of_one in decodes])


def _seconds(command: tuple[str, ...], python: Path) -> float:
    start = time.perf_counter()
    subprocess.run([python, *ISOLATED, *command], stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - start


def _cases(path: Path, threads: int, python: Path) -> dict[str, float]:
    done = subprocess.run([python, *ISOLATED, CASES, path, str(threads)], check=True, stdout=subprocess.PIPE)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def _print(name: str, seconds: list[float]) -> None:
    cells = [f"{1e3 * one:.3g}" if one < 0.1 else f"{1e3 * one:.0f}" for one in seconds]
    ratio = [] if len(seconds) < 2 else [f"{seconds[0] / seconds[1]:.2f}"]
    click.echo(f"| {' | '.join([name, *cells, *ratio])} |")
