"""What passes until an encode takes its first step, next to another version of the package in the same run."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import click

from benchmarks._turns import against, in_turn

__all__ = ["main"]

_CODE = """
import json, os, sys, time
from sgicodec.cli.main import main
from sgicodec.encoder.tile.sharing import SCOUT_PHASES
from sgicodec.fit.trainer import Trainer

spawned, found, seen, step = float(sys.argv.pop(1)), [], [], Trainer._step

def measured(self, *phase):
    taken = step(self, *phase)
    if self not in seen:
        seen.append(self)
        found.extend((time.process_time(), time.time() - spawned))
    if self.settings.phases != SCOUT_PHASES:
        print(json.dumps([*found[:2], *found[-2:]]), flush=True)
        os._exit(0)
    return taken

Trainer._step = measured
main()
"""
"""Runs `sgi` to the first step of the fit itself. From effort 2 on, a short one says before where seeds should be."""

ROWS = ("first step, processor", "first step, clock", "of the fit itself, processor", "of the fit itself, clock")


@click.command()
@click.argument("picture", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@against
@click.option("--effort", default=1, show_default=True, type=click.IntRange(1, 9))
@click.option("--repeat", default=9, show_default=True, type=click.IntRange(1), help="Processes, which take turns.")
def main(picture: Path, against: Path | None, effort: int, repeat: int) -> None:
    """Print milliseconds from the start of `sgi encode` with texture to the first step of its fits, least and median;
    with --against, those of the other version and the ratio of the least.
    """
    pythons = [Path(sys.executable), *([] if against is None else [against])]
    found = in_turn(pythons, repeat, partial(_until_steps, picture, effort))
    click.echo("| | ms | median |" + " other, ms | median | ratio |" * (against is not None))
    click.echo("|---|---:|---:|" + "---:|---:|---:|" * (against is not None))
    for row, name in enumerate(ROWS):
        values = [[run[row] for run in runs] for runs in found]
        cells = [f"{1e3 * some(of_one):.0f}" for of_one in values for some in (min, statistics.median)]
        ratio = [] if against is None else [f"{min(values[0]) / min(values[1]):.2f}"]
        click.echo(f"| {' | '.join([name, *cells, *ratio])} |")


def _until_steps(picture: Path, effort: int, python: Path) -> list[float]:
    with tempfile.TemporaryDirectory(prefix="sgi-start-") as folder:
        out = Path(folder, "out.sgi")
        options = "-e", str(effort), "--quiet"
        command = [str(python), "-I", "-c", _CODE, repr(time.time()), "encode", str(picture), str(out), *options]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    times: list[float] = json.loads(done.stdout)
    return times
