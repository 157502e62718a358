"""The paper's tables, measured again."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np

from benchmarks.paper.jobs import RATES, TABLES, Job, Scope, jobs
from benchmarks.paper.measure import Bench
from benchmarks.paper.report import report
from benchmarks.paper.rows import PaperResults, PaperRow
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.run import Sample, find_pictures, load_sample
from sgicodec.errors import SgiError, UsageError, require

STEPS, QUICK_STEPS = 15_000, 60
"""Of each fit: as published, and to see that everything runs."""

QUICK_SIDE = 160
"""Pixels of the square in the middle that a quick run takes."""

_FILE = click.Path(path_type=Path, dir_okay=False)


def middle(pixels: Pixels8, side: int) -> Pixels8:
    """The square in the middle, `side` pixels or all that there are."""
    top, left = (max(0, (length - side) // 2) for length in pixels.shape[:2])
    return np.ascontiguousarray(pixels[top : top + side, left : left + side])


@click.command()
@click.argument("pictures", nargs=-1, type=click.Path(path_type=Path))
@click.option("--table", "tables", multiple=True, type=click.Choice(list(TABLES)), help="Repeatable.  [default: all]")
@click.option(
    "--rate", "rates", multiple=True, type=click.Choice(list(RATES)), help="Of the comparison.  [default: all]"
)
@click.option("--steps", type=click.IntRange(5), help=f"Of each fit.  [default: {STEPS}]")
@click.option(
    "--seeds", type=click.IntRange(1), help="At K = 10; not in comparison and exact.  [default: 1800 a megapixel]"
)
@click.option(
    "--quick", is_flag=True, help=f"{QUICK_STEPS} steps on a crop of {QUICK_SIDE} pixels: shows that all runs."
)
@click.option("--tsv", type=_FILE, help="Add rows to this file, and do not measure again what it holds.")
@click.option("--streams", type=click.Path(path_type=Path, file_okay=False), help="Keep the streams in this folder.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(1))
@click.option("--each", is_flag=True, help="Print tables of each picture instead of means.")
@click.option("--from", "source", type=_FILE, help="Print the rows of a TSV, measure nothing.")
def main(
    pictures: tuple[Path, ...],
    tables: tuple[str, ...],
    rates: tuple[str, ...],
    steps: int | None,
    seeds: int | None,
    quick: bool,
    tsv: Path | None,
    streams: Path | None,
    threads: int,
    each: bool,
    source: Path | None,
) -> None:
    """Measure the tables of the paper on PICTURES, files or folders, and print them in Markdown beside what it prints.

    Every table is measured for all pictures before the next begins. A point that fails is reported and left out, and
    makes the command end with status 1.
    """
    if (source is None) == (not pictures):
        raise UsageError("give pictures to measure, or --from FILE to print what was measured")
    wanted = tables or tuple(TABLES)
    if source is not None:
        if not source.exists():
            raise UsageError(f"{source} does not exist")
        click.echo(report([row for row in PaperResults(source).rows.values() if row.table in wanted], each))
        return
    for library, extra in (("PIL", "bench"), ("scipy", "bench")):
        require(library, "the benchmark", extra)
    scope = Scope(steps or (QUICK_STEPS if quick else STEPS), seeds, rates or tuple(RATES), quick)
    results = PaperResults(tsv)
    with tempfile.TemporaryDirectory(prefix="sgi-paper-") as temporary:
        folder = Path(temporary) if streams is None else streams
        folder.mkdir(parents=True, exist_ok=True)
        found, failures = _measure(find_pictures(pictures), wanted, scope, Bench(folder, threads, quick), results)
    click.echo(report(found, each))
    if failures:
        raise SgiError(f"{len(failures)} points failed, the first of them: {failures[0]}")


def _measure(
    pictures: Sequence[Path], tables: Sequence[str], scope: Scope, bench: Bench, results: PaperResults
) -> tuple[list[PaperRow], list[str]]:
    """The rows of all tables, of which those in `results` are not measured again; and what failed."""
    rows: list[PaperRow] = []
    failures: list[str] = []
    for table in tables:
        for path in pictures:
            sample = load_sample(path)
            sample = Sample.of(sample.name, middle(sample.pixels, QUICK_SIDE)) if scope.quick else sample
            height, width = sample.pixels.shape[:2]
            for job in jobs(table, width * height, scope):
                try:
                    rows.append(_row(job, sample, bench, results))
                except SgiError as error:
                    failures.append(f"{table}, {sample.name}, {job.setting}, {job.method}: {error}")
                    click.echo(failures[-1], err=True)
    return rows, failures


def _row(job: Job, sample: Sample, bench: Bench, results: PaperResults) -> PaperRow:
    """The row of a job, measured if it is not there. Raises SgiError if it cannot be measured."""
    row = results.find(job.key(sample.name, sample.crc))
    if row is not None:
        return row
    beside = job.beside()
    row = bench.row(job, sample, None if beside is None else results.find(beside.key(sample.name, sample.crc)))
    results.append(row)
    size = "" if row.bytes is None else f", {row.bytes:,} bytes"
    seconds = "" if row.fit_seconds is None else f", {row.fit_seconds:.1f} s"
    click.echo(f"{job.table}, {sample.name}, {job.setting}, {job.method}: {row.psnr:.2f} dB{size}{seconds}", err=True)
    return row
