"""Many files by one command: which, under which names, each in its turn, one summary, and an exit code for all."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import click

from sgicodec.cli.files import complain
from sgicodec.cli.json_output import print_json
from sgicodec.cli.paths import STANDARD, display, local_name
from sgicodec.cli.progress import Mode, batch_progress
from sgicodec.errors import BatchError, SgiError, UsageError
from sgicodec.remote.url import is_url

__all__ = ["Batch", "Item", "batch_items"]


@dataclass(frozen=True)
class Item:
    """A file, and where its result goes: a path without extension. clash: the file whose result goes there already.
    failure: why a file, or a folder, cannot be looked into.
    """

    source: str
    stem: str
    clash: str | None = None
    failure: str = ""


def batch_items(
    paths: tuple[str, ...], folder: str | None, recursive: bool, wanted: Callable[[Path], bool]
) -> list[Item]:
    """All files of `paths`, and with `recursive` the wanted ones in folders and their subfolders.

    Results go into `folder`, in the same subfolders, or beside their sources. Of files whose names differ in the
    extension alone, results keep it: a.png and a.jpg become a.png.sgi and a.jpg.sgi. Files and folders that cannot be
    looked into are items that fail. Raises UsageError.
    """
    if STANDARD in paths:
        raise UsageError("stdin has no name; many files are taken by their names")
    unread: list[Item] = []
    found = [pair for path in paths for pair in _files(path, recursive, wanted, unread)]
    if not (found or unread):
        raise UsageError(f"there is nothing to take in {', '.join(map(display, paths))}")
    stems = [local_name(file) if folder is None else os.path.join(folder, under) for file, under in found]
    counts = Counter(os.path.splitext(stem)[0] for stem in stems)
    items, taken = [], dict[str, str]()
    for (file, _), stem in zip(found, stems, strict=True):
        bare = os.path.splitext(stem)[0]
        name = bare if counts[bare] == 1 else stem
        items.append(Item(file, name, taken.get(name)))
        taken.setdefault(name, file)
    return items + unread


def _files(path: str, recursive: bool, wanted: Callable[[Path], bool], unread: list[Item]) -> Iterator[tuple[str, str]]:
    """Each file, and its path below the folder that was named. unread: takes what cannot be looked into."""

    def fail(error: OSError) -> None:
        unread.append(Item(error.filename, error.filename, failure=error.strerror or str(error)))

    if not os.path.isdir(path):
        yield path, os.path.basename(local_name(path))
        return
    if not recursive:
        raise UsageError(f"{display(path)} is a folder; add -r to take the files in it")
    for folder, folders, names in os.walk(path, onerror=fail):
        folders.sort()
        for name in sorted(names):
            file = os.path.join(folder, name)
            try:
                if not name.startswith(".") and Path(file).is_file() and wanted(Path(file)):
                    yield file, os.path.relpath(file, path)
            except OSError as error:
                unread.append(Item(file, file, failure=error.strerror or str(error)))


@dataclass(frozen=True)
class Batch:
    """How many files are worked on. done: what is said of one, such as "encoded"."""

    done: str
    skip_existing: bool
    mode: Mode
    as_json: bool
    quiet: bool

    def run(self, items: list[Item], extension_of: Callable[[str], str], work: Callable[[str, str], int]) -> None:
        """Calls work(source, target), which returns bytes, for all; reports failures as they occur, then sums up.

        Raises BatchError if some failed. Ctrl-C ends the batch.
        """
        failed, skipped, finished, size, started = 0, 0, 0, 0, time.monotonic()
        with batch_progress(self.mode, len(items)) as draw:
            for number, item in enumerate(items):
                draw(number, display(item.source), time_left(len(items) - number, finished, time.monotonic() - started))
                try:
                    target = self._target(item, extension_of)
                    if self.skip_existing and os.path.exists(target):
                        skipped += 1
                        continue
                    _make_folder(os.path.dirname(target))
                    size += work(item.source, target)
                    finished += 1
                except SgiError as error:
                    failed += 1
                    complain(error, item.source, item.stem)
        self._sum_up(len(items), finished, skipped, failed, size)
        if failed:
            raise BatchError(f"{failed} of {len(items)} files failed")

    def _target(self, item: Item, extension_of: Callable[[str], str]) -> str:
        if item.failure:
            raise SgiError(f"{display(item.source)}: {item.failure}")
        target = f"{item.stem}.{extension_of(item.source)}"
        if item.clash is not None:
            raise UsageError(f"{display(item.source)}: {display(target)} is that of {display(item.clash)}")
        return target

    def _sum_up(self, files: int, finished: int, skipped: int, failed: int, size: int) -> None:
        if self.as_json:
            counts = {"files": files, self.done: finished, "skipped": skipped, "failed": failed}
            print_json(counts | {"bytes": size})
        elif not self.quiet:
            there = f", {skipped} there already" if skipped else ""
            click.echo(f"{finished} of {files} files {self.done}{there}, {size:,} bytes")


def time_left(files: int, finished: int, seconds: float) -> str:
    """How long so many files will take, if the finished ones took so many seconds; empty before the first."""
    if not finished:
        return ""
    left = files * seconds / finished
    if left < 60:
        return f"{max(1, round(left))} s left"
    minutes = round(left / 60)
    return f"{minutes} min left" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min left"


def _make_folder(folder: str) -> None:
    if is_url(folder):
        raise UsageError(f"{folder}: a URL can be read, not written; name a folder")
    try:
        os.makedirs(folder or ".", exist_ok=True)
    except OSError as error:
        raise UsageError(f"{display(folder)}: {error.strerror or error}") from error
