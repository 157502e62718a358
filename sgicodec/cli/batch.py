"""The files of a command: which, under which names, each of many in its turn, one summary and one exit code."""

from __future__ import annotations

import os
import stat
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import Any, Literal

import click

from sgicodec.cli.files import complain, failure
from sgicodec.cli.json_output import print_json
from sgicodec.cli.paths import STANDARD, check_output, display, local_name
from sgicodec.cli.progress import Mode, batch_progress
from sgicodec.errors import BatchError, SgiError, UsageError
from sgicodec.remote.url import is_url


@dataclass(frozen=True)
class Item:
    """A file, and where its result goes: a path without extension. clash: the file whose result goes there already.
    failure: why a file, or a folder, cannot be looked into.
    """

    source: str
    stem: str
    clash: str | None = None
    failure: str = ""


def _items(paths: tuple[str, ...], folder: str | None, recursive: bool, wanted: Callable[[Path], bool]) -> list[Item]:
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
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            file = os.path.join(folder, name)
            try:
                if not name.startswith(".") and stat.S_ISREG(os.stat(file).st_mode) and wanted(Path(file)):
                    yield file, os.path.relpath(file, path)
            except OSError as error:
                unread.append(Item(file, file, failure=error.strerror or str(error)))


@dataclass(frozen=True)
class Files:
    """The files that a command takes and writes, and what its options say of that."""

    paths: tuple[str, ...]
    output: str | None
    output_dir: str | None
    recursive: bool
    skip_existing: bool
    """Whether what has its OUT already is left out."""
    force: bool
    """Whether a file that is there may be overwritten."""
    progress: Mode
    as_json: bool
    quiet: bool

    @property
    def are_many(self) -> bool:
        """Whether they are taken one after the other."""
        return self.output_dir is not None or self.recursive

    @property
    def mode(self) -> Mode:
        """Of the progress with one of them."""
        return "off" if self.quiet or self.are_many else self.progress

    def check(self, source: str, target: str, becomes: Literal["stream", "picture"]) -> None:
        """Refuses what should not be written. Raises as `check_output`."""
        if self.as_json and target == STANDARD:
            raise UsageError(f"stdout cannot take both the {becomes} and --json; name OUT")
        by_default = (self.output_dir, self.output) == (None, None) and (self.recursive or len(self.paths) == 1)
        is_named = self.output is not None
        check_output(target, (source,), self.force, by_default=by_default, becomes=None if is_named else becomes)

    def is_done(self, source: str, target: str) -> bool:
        """Whether IN is to be skipped since it has its OUT, which --json tells."""
        if not self.skip_existing or not os.path.exists(target):
            return False
        if os.path.exists(source) and os.path.samefile(source, target):  # which is refused
            return False
        if self.as_json:
            print_json({"input": source, "output": target, "skipped": True})
        return True

    def each(
        self,
        content: str,
        misfit: type[SgiError],
        wanted: Callable[[Path], bool],
        extension_of: Callable[[str], str],
        done: str,
        work: Callable[[str, str | None], int],
    ) -> None:
        """Calls work(source, target), which returns bytes, for all; target is None where nobody named it. content: what
        they are, of which `misfit` tells that one is none; wanted: whether a file of a folder is; done: what is said of
        those that were worked on.
        """
        paths = self.paths
        if self.output is not None and (self.are_many or len(paths) > 1):
            raise UsageError("-o names the OUT of one IN; it does not go with another name, --output-dir or -r")
        if self.are_many:
            items = _items(paths, self.output_dir, self.recursive, wanted)
            self._one_by_one(items, extension_of, done, work)
            return
        if len(paths) > 2:
            raise click.UsageError(f"{len(paths)} names; give IN and OUT, or --output-dir for many {content}")
        if paths[0] != STANDARD and os.path.isdir(paths[0]):
            from sgicodec.image.zarr_reader import is_zarr  # takes long to load

            if not is_zarr(Path(paths[0])):  # which is a picture
                raise misfit(f"{display(paths[0])}: it is a folder; add -r to take the {content} in it")
        work(paths[0], self.output or (paths[1] if len(paths) == 2 else None))

    def _one_by_one(
        self, items: list[Item], extension_of: Callable[[str], str], done: str, work: Callable[[str, str], int]
    ) -> None:
        """Reports failures as they occur, then sums up. Raises BatchError if some failed. Ctrl-C ends it."""
        failed, skipped, finished, size, started = 0, 0, 0, 0, time.monotonic()
        with batch_progress("off" if self.quiet else self.progress, len(items)) as draw:
            for number, item in enumerate(items):
                left = _time_left(len(items) - number, finished, time.monotonic() - started)
                draw(number, display(item.source), left)
                try:
                    target = _target(item, extension_of)
                    if self.is_done(item.source, target):
                        skipped += 1
                        continue
                    _make_folder(os.path.dirname(target))
                    size += work(item.source, target)
                    finished += 1
                except Exception as error:
                    failed += 1
                    complain(failure(error), item.source, item.stem)
        if self.as_json:
            counts = {"files": len(items), done: finished, "skipped": skipped, "failed": failed}
            print_json(counts | {"bytes": size})
        elif not self.quiet:
            there = f", {skipped} there already" if skipped else ""
            click.echo(f"{finished} of {len(items)} files {done}{there}, {size:,} bytes")
        if failed:
            raise BatchError(f"{failed} of {len(items)} files failed")


def takes_files(command: Callable[..., None]) -> Callable[..., None]:
    """The command with the options that `Files` are made of instead of these, which are its first argument."""

    @wraps(command)
    def call(**given: Any) -> None:
        command(Files(**{field.name: given.pop(field.name) for field in fields(Files)}), **given)

    return call


def _target(item: Item, extension_of: Callable[[str], str]) -> str:
    if item.failure:
        raise SgiError(f"{display(item.source)}: {item.failure}")
    target = f"{item.stem}.{extension_of(item.source)}"
    if item.clash is not None:
        raise UsageError(f"{display(item.source)}: {display(target)} is that of {display(item.clash)}")
    return target


def _time_left(files: int, finished: int, seconds: float) -> str:
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
