"""Where the time of an encode goes, by module of the package. A decode is native code, which perf looks into.

The profiler of the standard library sees the thread that it runs in, and Python functions alone: what a native kernel
takes counts for the function that calls it.
"""

from __future__ import annotations

import cProfile
import pstats
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import click

import sgicodec
from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.device import Device

__all__ = ["OTHER", "by_module", "main", "profiled"]

OTHER = "Python and libraries"
_PACKAGE = Path(sgicodec.__file__).parent


def profiled(action: Callable[[], object], repeat: int = 1) -> pstats.Stats:
    """Statistics of `repeat` runs, after one that loads modules and finds memory."""
    action()
    profile = cProfile.Profile()
    with profile:
        for _ in range(repeat):
            action()
    return pstats.Stats(profile)


def by_module(stats: pstats.Stats, repeat: int = 1) -> dict[str, float]:
    """Seconds that functions of each module took themselves, most first; what is not of the package as OTHER."""
    seconds: dict[str, float] = defaultdict(float)
    for (file, _, _), (_, _, own, _, _) in stats.stats.items():  # type: ignore[attr-defined]
        path = Path(file)
        seconds[str(path.relative_to(_PACKAGE)) if path.is_relative_to(_PACKAGE) else OTHER] += own / repeat
    return dict(sorted(seconds.items(), key=lambda item: -item[1]))


@click.command()
@click.argument("path", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="PICTURE")
@click.option("--quality", default=50.0, show_default=True, type=click.FloatRange(1, 100), help="As of `sgi encode`.")
@click.option("--steps", default=200, show_default=True, type=click.IntRange(1), help="Of the fit.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(1))
@click.option(
    "--repeat", default=5, show_default=True, type=click.IntRange(1), help="Runs, of which means are printed."
)
@click.option("--functions", default=0, show_default=True, type=click.IntRange(0), help="Functions to list besides.")
def main(path: Path, quality: float, steps: int, threads: int, repeat: int, functions: int) -> None:
    """Encode PICTURE, and print milliseconds by module."""
    picture, settings = read(path), EncodeSettings(quality=quality, steps=steps)
    stats = profiled(lambda: encode_picture(picture, settings, device=Device(threads)), repeat)
    modules = by_module(stats, repeat)
    total = sum(modules.values())
    click.echo(f"{1e3 * total:.1f} ms, mean of {repeat}\n\n| module | ms | share |\n|---|---:|---:|")
    for name, seconds in modules.items():
        if seconds >= 0.002 * total:
            click.echo(f"| {name} | {1e3 * seconds:.2f} | {100 * seconds / total:.1f} % |")
    if functions:
        stats.sort_stats("tottime").print_stats(functions)
