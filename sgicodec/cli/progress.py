"""Progress bars: of a fit, and of an encode in several tiles."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Literal

from sgicodec.errors import require

if TYPE_CHECKING:
    from rich.console import Console

    from sgicodec.encoder.listener import PassState
    from sgicodec.fit.trainer import Progress

__all__ = ["Mode", "batch_progress", "fit_progress", "row_progress", "tile_progress"]

Mode = Literal["auto", "on", "off"]


@contextlib.contextmanager
def fit_progress(mode: Mode, pixels: int) -> Iterator[Callable[[Progress], None]]:
    """Draws a bar on stderr, with `auto` only on a terminal; yields what each step is to be reported to.

    pixels: of the picture, to show bits per pixel. They count the seeds' attributes alone, hence the ~.
    """
    if not _is_drawn(mode):
        yield lambda progress: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("fit"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[state]}"))
    with Bar(*columns, TimeRemainingColumn(), TextColumn("left"), console=_console(mode), refresh_per_second=4) as bar:
        task = bar.add_task("fit", total=None, state="")

        def draw(progress: Progress) -> None:
            rate = f"  ~{progress.bits / pixels:.3f} bpp" if progress.bits else ""
            state = f"{progress.psnr:.2f} dB{rate}"
            bar.update(task, completed=progress.step, total=progress.steps, state=state)

        yield draw


@contextlib.contextmanager
def tile_progress(mode: Mode) -> Iterator[Callable[[PassState], None]]:
    """The same for a pass over tiles: how many are done, speed, bits per pixel and PSNR so far, time left."""
    if not _is_drawn(mode):
        yield lambda state: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[state]}"))
    with Bar(*columns, console=_console(mode), refresh_per_second=4) as bar:
        task = bar.add_task("tiles", total=None, state="")

        def draw(state: PassState) -> None:
            bar.update(task, description=state.name, completed=state.done, total=state.tiles, state=_text(state))

        yield draw


@contextlib.contextmanager
def row_progress(mode: Mode, rows: int | None) -> Iterator[Callable[[int], None]]:
    """The same for a picture that is written row by row; None for one that comes at once."""
    if not _is_drawn(mode):
        yield lambda done: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    counts = () if rows is None else (MofNCompleteColumn(), TextColumn("rows"), TimeRemainingColumn())
    with Bar(TextColumn("decode"), BarColumn(), *counts, console=_console(mode), refresh_per_second=4) as bar:
        task = bar.add_task("decode", total=rows)
        yield lambda done: bar.update(task, completed=done)


@contextlib.contextmanager
def batch_progress(mode: Mode, files: int) -> Iterator[Callable[[int, str, str], None]]:
    """The same for many files: yields what takes how many are done, the name of the next, and the time left."""
    if not _is_drawn(mode):
        yield lambda done, name, left: None
        return
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.fields[text]}", markup=False), BarColumn())
    with Bar(*columns, console=_console(mode), refresh_per_second=4) as bar:
        task = bar.add_task("files", total=files, text="")

        def draw(done: int, name: str, left: str) -> None:
            counted = f"{done + 1} of {files}" + (f", {left}" if left else "")
            bar.update(task, completed=done, text=f"{counted}  {name}")

        yield draw


def _text(state: PassState) -> str:
    parts = []
    if state.fresh:
        parts.append(f"{60e-6 * state.pixels_per_second:.2f} MP/min")
    if state.samples:
        parts.append(f"{state.bpp:.3f} bpp  {state.psnr:.2f} dB")
    if state.fresh:
        minutes, seconds = divmod(round(state.seconds_left), 60)
        parts.append(f"{minutes // 60}:{minutes % 60:02}:{seconds:02} left")
    return "  ".join(parts)


def _is_drawn(mode: Mode) -> bool:
    drawn = mode == "on" or (mode == "auto" and sys.stderr.isatty())
    if drawn:
        require("rich", "a progress bar")
    return drawn


def _console(mode: Mode) -> Console:
    from rich.console import Console

    return Console(stderr=True, force_terminal=True if mode == "on" else None)
