"""What the command line does while an encode runs: bars, a line on workers and memory, Ctrl-C."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from types import TracebackType
from typing import TYPE_CHECKING

import click

from sgicodec.cli.interrupt import EarlyEnd
from sgicodec.cli.paths import STANDARD, display
from sgicodec.cli.progress import Mode, fit_progress, tile_progress
from sgicodec.encoder.listener import NullListener, PassState
from sgicodec.executors.executor import MIB, Memory

if TYPE_CHECKING:
    from sgicodec.encoder.plan import Plan
    from sgicodec.fit.trainer import Progress

__all__ = ["EncodeListener"]


class EncodeListener(NullListener):
    """A context manager around an encode. plan: known once it has begun."""

    plan: Plan

    def __init__(self, mode: Mode, quiet: bool, on_cluster: bool, source: str = STANDARD) -> None:
        self._mode, self._quiet, self._on_cluster, self._source = mode, quiet, on_cluster, source
        self._stack, self._early, self._told = ExitStack(), EarlyEnd(), False
        self._draw_fit: Callable[[Progress], None] = lambda _: None
        self._draw_tiles: Callable[[PassState], None] = lambda _: None

    def __enter__(self) -> EncodeListener:
        self._stack.enter_context(self._early)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    @property
    def tiles(self) -> int:
        """How many tiles the picture has."""
        return self.plan.header.grid.count

    @property
    def ended_early(self) -> bool:
        """Whether Ctrl-C ended the fit."""
        return self._early.asked

    def planned(self, plan: Plan, workers: int, memory: Memory) -> None:
        """Says what the encode will take, and begins a bar."""
        self.plan, header = plan, plan.header
        if not header.tile:
            self._draw_fit = self._stack.enter_context(fit_progress(self._mode, header.width * header.height))
            return
        if not self._quiet:
            _, _, width, height = header.grid.rect(0)
            text = f"{header.grid.count} tiles of {width}×{height} pixels, "
            if self._on_cluster:
                text += f"{workers} at once on the cluster, each about {memory.worker / MIB:,.0f} MiB of memory"
            else:
                text += f"{workers} worker{'s' * (workers > 1)}, about {memory.total(workers) / MIB:,.0f} MiB of memory"
            click.echo(text, err=True)
        self._draw_tiles = self._stack.enter_context(tile_progress(self._mode))

    def step(self, progress: Progress) -> bool:
        """From the first step on, Ctrl-C ends the fit."""
        self._early.arm()
        self._draw_fit(progress)
        if self._early.asked:
            self._tell(f"interrupted at step {progress.step} of {progress.steps}; writing what is there")
        return not self._early.asked

    def ending(self) -> bool:
        """Whether Ctrl-C was pressed."""
        if self._early.asked:
            self._tell("interrupted after the fit; writing what is there")
        return self._early.asked

    def _tell(self, text: str) -> None:
        if not self._quiet and not self._told:
            click.echo(f"sgi: {text}", err=True)
        self._told = True

    def note(self, text: str) -> None:
        """One line, which even --quiet does not keep back."""
        click.echo(f"sgi: {display(self._source)}: {text}", err=True)

    def tile(self, state: PassState) -> None:
        """Draws the bar."""
        self._draw_tiles(state)
