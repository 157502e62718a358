"""The progress bar of a fit."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["Mode", "fit_progress"]

Mode = Literal["auto", "on", "off"]


@contextlib.contextmanager
def fit_progress(mode: Mode, pixels: int) -> Iterator[Callable[[Progress], None]]:
    """Draws a bar on stderr, with `auto` only on a terminal; yields what each step is to be reported to.

    pixels: of the picture, to show bits per pixel. They count the seeds' attributes alone, hence the ~.
    """
    if mode == "off" or (mode == "auto" and not sys.stderr.isatty()):
        yield lambda progress: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("fit"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[state]}"))
    console = Console(stderr=True, force_terminal=True if mode == "on" else None)
    with Bar(*columns, TimeRemainingColumn(), TextColumn("left"), console=console, refresh_per_second=4) as bar:
        task = bar.add_task("fit", total=None, state="")

        def draw(progress: Progress) -> None:
            rate = f"  ~{progress.bits / pixels:.3f} bpp" if progress.bits else ""
            state = f"{progress.psnr:.2f} dB{rate}"
            bar.update(task, completed=progress.step, total=progress.steps, state=state)

        yield draw
