"""Several files by one command, one after the other."""

from __future__ import annotations

from collections.abc import Callable

import click

from sgicodec.cli.paths import display
from sgicodec.cli.texts import NO_MEMORY
from sgicodec.errors import BatchError, SgiError


def each_file(sources: tuple[str, ...], work: Callable[[str], None]) -> None:
    """Calls work(source) for all sources; reports failures as they occur. Raises what a single one does, or BatchError
    if some of many failed.
    """
    if len(sources) == 1:
        work(sources[0])
        return
    failed = 0
    for source in sources:
        try:
            work(source)
        except Exception as error:
            failed += 1
            complain(failure(error), source)
    if failed:
        raise BatchError(f"{failed} of {len(sources)} files failed")


def failure(error: Exception) -> SgiError:
    """What to say of one file that failed, where others follow. Raises what is none of its faults."""
    if isinstance(error, SgiError):
        return error
    if isinstance(error, MemoryError) or any(text in str(error) for text in NO_MEMORY):
        return SgiError("there is not enough memory")
    raise error


def complain(error: SgiError, *names: str) -> None:
    """Prints an error as one line that names one of the files."""
    text = str(error)
    named = text if any(display(name) in text for name in names) else f"{display(names[0])}: {text}"
    click.echo(f"sgi: {one_line(named)}", err=True)


def one_line(message: str) -> str:
    """A message in one line, without what could steer a terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in " ".join(message.split()))
