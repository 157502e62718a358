"""Progress bars: of an encode, of a decode, of many files."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Literal

from sgicodec.errors import require

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from sgicodec.encoder.progress import PassState, StageClock
    from sgicodec.fit.trainer import Progress

__all__ = ["Mode", "batch_progress", "clock", "encode_progress", "fit_text", "row_progress", "tile_text"]

Mode = Literal["auto", "on", "off"]


@contextlib.contextmanager
def encode_progress(mode: Mode, stages: StageClock) -> Iterator[Callable[[str], None]]:
    """Draws one bar on stderr for a whole encode, with `auto` only on a terminal; yields what takes a text beside it.

    The bar shows the clock's stage and its share of the whole, also while native code computes.
    """
    if not _is_drawn(mode):
        yield lambda text: None
        return
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn
    from rich.progress import Progress as Bar

    class Clocked(Bar):
        def get_renderables(self) -> Iterable[RenderableType]:
            for task in self.tasks:
                task.completed, left = stages.fraction, stages.seconds_left
                task.description, task.fields["left"] = stages.name, "" if left is None else f"{clock(left)} left"
            return super().get_renderables()

    texts = [TextColumn(f"{{task.fields[{name}]}}", markup=False) for name in ("left", "state")]
    columns = (TextColumn("{task.description:<8}"), BarColumn(), TaskProgressColumn(), *texts)
    with Clocked(*columns, console=_console(mode), refresh_per_second=4) as bar:
        task = bar.add_task(stages.name, total=1.0, left="", state="")
        yield lambda text: bar.update(task, state=text)


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
    if state.samples:
        parts.append(f"{state.bpp:.3f} bpp  {state.psnr:.2f} dB")
    return "  ".join(parts)


def clock(seconds: float) -> str:
    """A time as h:mm:ss; one that is not over is at least a second."""
    minutes, rest = divmod(max(1, round(seconds)), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{rest:02}"


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
