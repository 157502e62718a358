"""What the command line does while an encode runs: bars, a line on workers and memory, Ctrl-C."""

from __future__ import annotations

from contextlib import ExitStack
from types import TracebackType
from typing import TYPE_CHECKING

import click

from sgicodec.cli.interrupt import EarlyEnd
from sgicodec.cli.paths import STANDARD, display
from sgicodec.cli.progress import EncodeBar, Mode, encode_progress, fit_text, tile_text
from sgicodec.encoder.progress import NullListener, PassState
from sgicodec.executors.available import group_memory
from sgicodec.executors.executor import MIB, Memory

if TYPE_CHECKING:
    from sgicodec.encoder.plan import Plan
    from sgicodec.fit.trainer import Progress


class EncodeListener(NullListener):
    """A context manager around an encode. plan: known once it has begun."""

    plan: Plan

    def __init__(self, mode: Mode, quiet: bool, on_cluster: bool, source: str = STANDARD) -> None:
        self._mode, self._quiet, self._on_cluster, self._source = mode, quiet, on_cluster, source
        self._stack, self._early, self._told = ExitStack(), EarlyEnd(), False
        self._bar, self._pixels, self._has_texture = EncodeBar(), 1, False

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
        """Says what the encode will take, and begins the bar."""
        self.plan, header, self._has_texture = plan, plan.header, plan.header.spec.texture
        self._pixels = header.width * header.height
        if header.tile and not self._quiet:
            _, _, width, height = header.grid.rect(0)
            text = f"{header.grid.count} tiles of {width}×{height} pixels, "
            if self._on_cluster:
                text += f"{workers} at once on the cluster, each about {memory.worker / MIB:,.0f} MiB of memory"
            else:
                text += f"{workers} worker{'s' * (workers > 1)}, about {memory.total(workers) / MIB:,.0f} MiB of memory"
            click.echo(text, err=True)
        limit = None if self._on_cluster else group_memory()
        if limit is not None and memory.total(workers) > limit and not self._quiet:
            text = f"this takes about {memory.total(workers) / MIB:,.0f} MiB, and its control group may have "
            self.note(f"{text}{limit / MIB:,.0f}; the system may end it. A smaller --tile takes less")
        self._bar = self._stack.enter_context(encode_progress(self._mode))

    def stage(self, name: str) -> None:
        """Moves the bar."""
        self._bar.show(name)

    def step(self, progress: Progress) -> bool:
        """From the first step on, Ctrl-C ends the fit."""
        self._early.arm()
        share = progress.step / max(1, progress.steps)
        self._bar.show("fit", share, fit_text(progress, self._pixels, self._has_texture))
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

    def remark(self, text: str) -> None:
        """The same, which --quiet keeps back."""
        if not self._quiet:
            self.note(text)

    def tile(self, state: PassState) -> None:
        """Draws the bar."""
        self._bar.show(state.name, state.pixels / max(1, state.all_pixels), tile_text(state))
