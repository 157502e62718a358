"""What a step of the paper profile takes in each phase of its fit, beside the rasteriser's passes over the same
Gaussians.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks.paper.command import STEPS
from benchmarks.paper.jobs import RATES
from sgicodec.bench.run import load_sample
from sgicodec.device import Device
from sgicodec.fit.trainer import Trainer
from sgicodec.model.layout import uniform_layout
from sgicodec.profiles.fit_settings import Phase
from sgicodec.profiles.paper import paper_settings, paper_spec
from sgicodec.raster.cpu import NativeRasterizer

__all__ = ["Cost", "Times", "main", "measure", "table"]

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Times:
    """Seconds by the clock and of all processors, medians."""

    clock: float
    processors: float


@dataclass(frozen=True)
class Cost:
    """phase: as in the whole fit; step: all of a step, Adam included; raster: forward and backward of its Gaussians."""

    phase: Phase
    step: Times
    raster: Times

    @property
    def name(self) -> str:
        """Size and what the phase does."""
        size = "full size" if not self.phase.level else f"1/{1 << self.phase.level} of the size"
        return f"{size}, {'bits count' if self.phase.rate else self.phase.rounding.replace('none', 'free')}"


class _Recorder:
    """A rasteriser that remembers the Gaussians that it compared last, and the picture."""

    gaussians: tuple[F32, F32, F32]
    target: F32

    def __init__(self, raster: NativeRasterizer) -> None:
        self.raster = raster

    def error(self, means: F32, covariances: F32, colours: F32, target: F32, *comparison: Any) -> Any:
        self.gaussians, self.target = (means, covariances, colours), target
        return self.raster.error(means, covariances, colours, target, *comparison)

    def again(self) -> None:
        """Forward and backward of the last Gaussians."""
        self.raster.forward(*self.gaussians, self.target.shape[2], self.target.shape[1])
        self.raster.backward(*self.gaussians, self.target)


def measure(target: F32, seeds: int, warm: int, repeat: int, device: Device) -> Iterator[Cost]:
    """Costs of the phases of a fit of `target` [C, H, W], after a fit of `warm` steps."""
    _, height, width = target.shape
    whole = paper_settings(0.001, 3, STEPS)
    phases = [replace(phase, steps=repeat + 1) for phase in whole.phases]  # the first step finds memory
    before = paper_settings(0.001, 3, warm).phases if warm else ()
    layout = uniform_layout(width, height, seeds, np.random.default_rng(0))
    settings = replace(whole, phases=(*before, *phases))
    trainer = Trainer(paper_spec(len(target)), settings, target, layout, 0, device=device)
    raster = _Recorder(trainer.raster)
    trainer.gradient_step.raster = raster  # type: ignore[attr-defined]
    steps = trainer.iterate()
    for _ in range(sum(phase.steps for phase in before)):
        next(steps)
    for phase in whole.phases:
        turns = [(_timed(lambda: next(steps)), _timed(raster.again)) for _ in range(repeat + 1)][1:]
        yield Cost(phase, *(_medians(times) for times in zip(*turns, strict=True)))


def _timed(action: Any) -> Times:
    began, cpu_began = time.perf_counter(), time.process_time()
    action()
    return Times(time.perf_counter() - began, time.process_time() - cpu_began)


def _medians(times: tuple[Times, ...]) -> Times:
    return Times(median(one.clock for one in times), median(one.processors for one in times))


def table(costs: list[Cost]) -> str:
    """In Markdown, with what all steps of the fit take."""
    lines = [
        "| | step, ms | rasteriser | ratio | of the processors: step | rasteriser | ratio |",
        "|---|---|---|---|---|---|---|",
    ]
    for cost in costs:
        step, raster = cost.step, cost.raster
        pairs = ((step.clock, raster.clock), (step.processors, raster.processors))
        cells = " | ".join(f"{1e3 * a:.2f} | {1e3 * b:.2f} | {a / b:.2f}" for a, b in pairs)
        lines.append(f"| {cost.name} | {cells} |")
    clock, processors = (
        sum(cost.phase.steps * getattr(cost.step, kind) for cost in costs) / 60 for kind in ("clock", "processors")
    )
    steps = sum(cost.phase.steps for cost in costs)
    return (
        "\n".join(lines) + f"\n\nAll {steps:,} steps at this pace: {clock:.1f} min, {processors:.1f} of the processors."
    )


@click.command()
@click.argument("path", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="PICTURE")
@click.option("--seeds", type=click.IntRange(1), help="At K = 10.  [default: 1800 a megapixel]")
@click.option("--fit", "warm", default=300, show_default=True, type=click.IntRange(0), help="Steps before measuring.")
@click.option("--repeat", default=12, show_default=True, type=click.IntRange(1), help="Steps, of which medians count.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(1))
def main(path: Path, seeds: int | None, warm: int, repeat: int, threads: int) -> None:
    """Time the steps of a fit of PICTURE in the paper profile, and print them beside the rasteriser's."""
    pixels = load_sample(path).pixels
    target = np.ascontiguousarray(pixels.transpose(2, 0, 1), np.float32) / np.float32(255)
    seeds = seeds or max(1, round(RATES["low"] * pixels.shape[0] * pixels.shape[1] / 1e6))
    click.echo(f"{path.name}, {pixels.shape[1]}×{pixels.shape[0]}, {10 * seeds:,} Gaussians, {threads} threads\n")
    click.echo(table(list(measure(target, seeds, warm, repeat, Device(threads)))))
