"""The command `sgi` as a user types it, run in this process."""

from __future__ import annotations

from click.testing import CliRunner, Result

from sgicodec.cli.main import cli

__all__ = ["sgi"]


def sgi(*arguments: object, stdin: bytes | None = None) -> Result:
    """Runs `sgi ARGUMENTS…`; `stdin` are bytes."""
    return CliRunner().invoke(cli, [str(argument) for argument in arguments], input=stdin)
