"""Several files by one command, one after the other."""

from __future__ import annotations

from collections.abc import Callable

import click

from sgicodec.cli.paths import display
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
        except SgiError as error:
            failed += 1
            complain(error, source)
    if failed:
        raise BatchError(f"{failed} of {len(sources)} files failed")


def complain(error: SgiError, *names: str) -> None:
    """Prints an error as one line that names one of the files."""
    text = str(error)
    named = text if any(display(name) in text for name in names) else f"{display(names[0])}: {text}"
    click.echo(f"sgi: {' '.join(named.split())}", err=True)
