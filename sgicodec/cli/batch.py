"""Many files by one command: each in its turn, one summary, and an exit code for all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from sgicodec.cli.files import complain
from sgicodec.cli.json_output import print_json
from sgicodec.cli.paths import STANDARD, display
from sgicodec.errors import BatchError, SgiError, UsageError

__all__ = ["named_targets", "run_batch"]


def named_targets(sources: tuple[str, ...], folder: str, extension_of: Callable[[str], str]) -> list[tuple[str, str]]:
    """Each source with its target: its name with another extension, in `folder`, which is made if it is missing.

    A source without an extension_of (SgiError) fails later, in its turn. Raises UsageError for two of one name.
    """
    if STANDARD in sources:
        raise UsageError("stdin has no name; --output-dir takes files")
    taken: dict[str, str] = {}
    pairs = []
    for source in sources:
        try:
            extension = extension_of(source)
        except SgiError:
            extension = "png"
        target = str(Path(folder) / f"{Path(source).stem}.{extension}")
        if target in taken:
            raise UsageError(f"{display(taken[target])} and {display(source)} would both become {display(target)}")
        taken[target] = source
        pairs.append((source, target))
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{display(folder)}: {error.strerror or error}") from error
    return pairs


def run_batch(
    done: str, pairs: list[tuple[str, str]], work: Callable[[str, str], int], as_json: bool = False, quiet: bool = False
) -> None:
    """Calls work(source, target), which returns bytes, for all pairs; reports failures as they occur, then sums up.

    Raises BatchError if some failed. Ctrl-C ends the batch.
    """
    failed, finished, size = 0, 0, 0
    for source, target in pairs:
        try:
            size += work(source, target)
            finished += 1
        except SgiError as error:
            failed += 1
            complain(error, source, target)
    if as_json:
        print_json({"files": len(pairs), done: finished, "failed": failed, "bytes": size})
    elif not quiet:
        click.echo(f"{finished} of {len(pairs)} files {done}, {size:,} bytes")
    if failed:
        raise BatchError(f"{failed} of {len(pairs)} files failed")
