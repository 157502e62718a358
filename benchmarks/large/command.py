"""sgi and its peers on pictures of many megapixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click

from benchmarks.large.notes import Job
from benchmarks.large.peers import LARGE_PEERS, LargePeer
from benchmarks.large.rows import LargeRow, report, write_rows
from benchmarks.large.runs import FAILED, check_picture, rows_of
from benchmarks.large.scaling import SizePoint, measure_size, write_size_plot, write_sizes
from sgicodec.bench.options import numbers
from sgicodec.errors import SgiError, UsageError, require
from sgicodec.image import probe

__all__ = ["main"]


def _peers(names: str, threads: int) -> list[LargePeer]:
    """Raises UsageError for a peer that does not exist, or whose library is missing."""
    peers = []
    for name in filter(None, map(str.strip, names.split(","))):
        if name not in LARGE_PEERS:
            raise UsageError(f"no peer is called {name!r}; there are {', '.join(LARGE_PEERS)}")
        peers.append(LARGE_PEERS[name](threads))
        peers[-1].version()
    return peers


def _check(pictures: Sequence[Path], peers: Sequence[LargePeer]) -> None:
    """Raises UsageError for what would fail after hours."""
    if len({picture.stem for picture in pictures}) < len(pictures):
        raise UsageError("two pictures have the same name; rows and streams would be mixed up")
    for picture in pictures if peers else ():
        check_picture(picture)


def _compare(
    pictures: Sequence[Path], efforts: Sequence[int], peers: Sequence[LargePeer], job: Job, table: Path
) -> list[LargeRow]:
    rows: list[LargeRow] = []
    for picture in pictures if efforts else ():
        for row in rows_of(picture, efforts, peers, job):
            rows.append(row)
            write_rows(rows, table)
            click.echo(f"{row.picture}, effort {row.effort}, {row.codec}: {row.note or 'done'}", err=True)
    return rows


def _grow(picture: Path, sizes: Sequence[float], job: Job, out: Path) -> None:
    """Measures squares of a picture and draws the two plots."""
    points: list[SizePoint] = []
    for size in sorted(sizes):
        point = measure_size(picture, size, 1, job)
        if point is None:
            click.echo(f"{size:g} megapixels: {picture.name} has no such square", err=True)
            continue
        points.append(point)
        write_sizes(points, out / "results" / "large-scaling.tsv")
        click.echo(f"{size:g} megapixels: done", err=True)
    if points:
        write_size_plot(points, "seconds", "seconds", out / "images" / "large-time.png")
        write_size_plot(points, "mib", "peak MiB", out / "images" / "large-memory.png")


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--efforts", default="1,5", show_default=True, help="Efforts of sgi; none for the plots alone.")
@click.option("--peers", default=",".join(LARGE_PEERS), show_default=True, help="Codecs to compare with.")
@click.option("--workers", default=2, show_default=True, type=click.IntRange(1), help="And threads of the peers.")
@click.option("--streams", default=Path("bench-out", "large"), show_default=True, type=click.Path(path_type=Path))
@click.option("--sizes", default="4,8,16,32,64,128", show_default=True, help="Megapixels of the squares for the plots.")
@click.option("--steps", default=20, show_default=True, type=click.IntRange(1), help="Of the fits for the plots.")
@click.option("--table-steps", type=click.IntRange(1), help="Of the fits for the table, instead of what efforts say.")
@click.option("--tile", type=click.IntRange(0), help="As in sgi encode.")
@click.option("--out", default=Path("docs"), show_default=True, type=click.Path(path_type=Path), help="Folder.")
def main(
    pictures: tuple[Path, ...],
    efforts: str,
    peers: str,
    workers: int,
    streams: Path,
    sizes: str,
    steps: int,
    table_steps: int | None,
    tile: int | None,
    out: Path,
) -> None:
    """Measure sgi on PICTURES, peers at the same PSNR, and how time and memory grow.

    Writes OUT/results/large.tsv; from squares of the largest picture OUT/results/large-scaling.tsv and
    OUT/images/large-time.png and large-memory.png. What is measured is noted in the folder --streams at once: a run
    that was stopped goes on where it was.
    """
    require("matplotlib", "the benchmark", "bench")
    codecs = _peers(peers, workers)
    _check(pictures, codecs)
    for folder in (streams, out / "results", out / "images"):
        folder.mkdir(parents=True, exist_ok=True)
    job, table = Job(streams, workers, table_steps, tile), out / "results" / "large.tsv"
    rows = _compare(pictures, [int(effort) for effort in numbers(efforts, "--efforts")], codecs, job, table)
    if rows:
        click.echo(report(rows))
    largest = max(pictures, key=lambda picture: probe(picture).width * probe(picture).height)
    _grow(largest, numbers(sizes, "--sizes"), replace(job, steps=steps), out)
    if any(row.note.startswith(FAILED) for row in rows):
        raise SgiError("some codecs failed; see their notes")
