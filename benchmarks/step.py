"""What a step of a fit spends where: `python -m benchmarks.step PICTURES… [--steps 1000] [--threads 2] [--whole]`.

A whole fit runs with a clock around its parts; the rows are milliseconds per step, averaged over all of its steps,
since seeds come and go. With --whole: the seconds of a whole encode instead, from pixels to the stream.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile_encoder import Encoding
from sgicodec.fit.adam import Adam
from sgicodec.fit.fused_step import SeedStep
from sgicodec.fit.trainer import Trainer
from sgicodec.image import read
from sgicodec.picture import Picture

__all__ = ["PARTS", "Spent", "main", "spent", "stages"]

PARTS: dict[str, list[tuple[type, str]]] = {
    "drawing, forward and backward": [(SeedStep, "_draw")],
    "values, noise, MLP_p, bits, and their gradients": [(SeedStep, "run")],
    "Adam": [(Adam, "step")],
    "dropping and adding seeds": [(Trainer, "_prune"), (Trainer, "_grow")],
    "learning rates, and what is left": [(Trainer, "_step")],
}
"""Methods that are timed; a part does not count what a part above it counts."""


@dataclass(frozen=True)
class Spent:
    """Seconds of the parts of a fit, by name, of so many steps; seeds at its end."""

    seconds: dict[str, float]
    steps: int
    seeds: int


def spent(picture: Picture, settings: EncodeSettings) -> Spent:
    """Fits a picture, search not included."""
    totals: dict[str, float] = defaultdict(float)
    with ExitStack() as stack:
        for name, methods in PARTS.items():
            for owner, method in methods:
                stack.enter_context(_timed(owner, method, name, totals))
        encoding = Encoding(picture, stream_plan(Shape.of(picture), settings), time.monotonic())
        fitted = encoding.fitted(None)
    names = list(PARTS)
    drawing, run, adam, step = (totals[names[i]] for i in (0, 1, 2, 4))
    seconds = {names[0]: drawing, names[1]: run - drawing, names[2]: adam, names[3]: totals[names[3]]}
    seconds[names[4]] = step - run - adam
    return Spent(seconds, encoding.fit.steps, len(fitted.layout))


def stages(picture: Picture, settings: EncodeSettings) -> tuple[dict[str, float], int]:
    """Seconds of the stages of an encode, and the number of seeds that are left."""
    clock = [time.perf_counter()]
    encoding = Encoding(picture, stream_plan(Shape.of(picture), settings), time.monotonic())
    clock.append(time.perf_counter())
    candidate = encoding.candidate(encoding.fitted(None))
    clock.append(time.perf_counter())
    candidate = encoding.searched(candidate)
    clock.append(time.perf_counter())
    encoded = encoding.encoded(candidate)
    clock.append(time.perf_counter())
    names = ("base layer", "fit", "search", "stream")
    return {name: b - a for name, a, b in zip(names, clock, clock[1:], strict=False)}, encoded.seeds


@contextmanager
def _timed(owner: type, method: str, name: str, totals: dict[str, float]) -> Iterator[None]:
    plain: Callable[..., Any] = getattr(owner, method)

    def timed(*arguments: Any, **named: Any) -> Any:
        started = time.perf_counter()
        try:
            return plain(*arguments, **named)
        finally:
            totals[name] += time.perf_counter() - started

    setattr(owner, method, timed)
    try:
        yield
    finally:
        setattr(owner, method, plain)


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--steps", default=1000, show_default=True, type=click.IntRange(1))
@click.option("--quality", default=50.0, show_default=True, type=click.FloatRange(1, 100))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
@click.option("--whole", is_flag=True, help="Seconds of whole encodes instead.")
def main(pictures: tuple[Path, ...], steps: int, quality: float, threads: int, whole: bool) -> None:
    """Fit PICTURES and print where the time of a step goes."""
    for path in pictures:
        picture, settings = read(path), EncodeSettings(quality=quality, steps=steps, threads=threads)
        if whole:
            by_stage, seeds = stages(picture, settings)
            total, megapixels = sum(by_stage.values()), picture.width * picture.height / 1e6
            parts = ", ".join(f"{name} {value:.2f} s" for name, value in by_stage.items())
            click.echo(f"{path.stem}: {parts}; {total / megapixels:.1f} s per megapixel; {seeds} seeds")
            continue
        one = spent(picture, settings)
        total = sum(one.seconds.values())
        click.echo(f"{path.stem}, {one.seeds} seeds at the end, {1e3 * total / one.steps:.2f} ms per step\n")
        click.echo("| part | ms | share |\n|---|---:|---:|")
        for name, seconds in one.seconds.items():
            click.echo(f"| {name} | {1e3 * seconds / one.steps:.2f} | {100 * seconds / total:.1f} % |")
        click.echo("")


if __name__ == "__main__":
    main()
