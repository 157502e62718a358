"""Progress bars: of an encode, of a decode, of many files."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Literal

from sgicodec.errors import require

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as Bar

    from sgicodec.encoder.progress import PassState
    from sgicodec.fit.trainer import Progress

Mode = Literal["auto", "on", "off"]


class EncodeBar:
    """The bar of an encode: its stage, which share of that is done, where that is known, and a text beside it."""

    def __init__(self, bar: Bar | None = None) -> None:
        self._bar = bar
        self._task = None if bar is None else bar.add_task("load", total=None, state="")

    def show(self, stage: str, share: float | None = None, text: str | None = None) -> None:
        """share: None where the stage does not say it; text: None for the one that is there."""
        if self._bar is not None and self._task is not None:
            total, done = (None, 0.0) if share is None else (1.0, share)
            self._bar.update(self._task, description=stage, total=total, completed=done)
            if text is not None:
                self._bar.update(self._task, state=text)


@contextlib.contextmanager
def encode_progress(mode: Mode) -> Iterator[EncodeBar]:
    """The bar on stderr, with `auto` only on a terminal."""
    if not _is_drawn(mode):
        yield EncodeBar()
        return
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (TextColumn("{task.description:<8}"), BarColumn(), TextColumn("{task.fields[state]}", markup=False))
    with Progress(*columns, console=_console(mode), refresh_per_second=4) as bar:
        yield EncodeBar(bar)


def fit_text(progress: Progress, pixels: int, has_texture: bool) -> str:
    """How far the fit of a picture of so many pixels is. Its bits count the seeds' attributes alone, hence the ~.
    has_texture: whether texture comes on top, without which PSNR and bits say nothing of the stream.
    """
    text = f"step {progress.step} of {progress.steps}"
    if has_texture:
        return text
    rate = f"  ~{progress.bits / pixels:.3f} bpp" if progress.bits else ""
    return f"{text}  {progress.psnr:.2f} dB{rate}"


def tile_text(state: PassState) -> str:
    """How far a pass over tiles is."""
    parts = [f"{state.done} of {state.tiles} {state.name}"]
    if state.fresh:
        parts.append(f"{60e-6 * state.pixels_per_second:.2f} MP/min")
    if state.bytes:
        parts.append(f"{state.bpp:.3f} bpp")
    return "  ".join(parts)


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


def _is_drawn(mode: Mode) -> bool:
    drawn = mode == "on" or (mode == "auto" and sys.stderr.isatty())
    if drawn:
        require("rich", "a progress bar")
    return drawn


def _console(mode: Mode) -> Console:
    from rich.console import Console

    return Console(stderr=True, force_terminal=True if mode == "on" else None)
