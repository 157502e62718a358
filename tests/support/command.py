"""The command `sgi` as a user types it, run in this process."""

from __future__ import annotations

import json
from typing import Any

from click.testing import CliRunner, Result

from sgicodec.cli.main import cli


def sgi(*arguments: object, stdin: bytes | None = None) -> Result:
    """Runs `sgi ARGUMENTS…`; `stdin` are bytes."""
    return CliRunner().invoke(cli, [str(argument) for argument in arguments], input=stdin)


def done(*arguments: object, stdin: bytes | None = None) -> Result:
    """Runs a command that must succeed."""
    result = sgi(*arguments, stdin=stdin)
    assert result.exit_code == 0, result.output
    return result


def told(*arguments: object) -> dict[str, Any]:
    """What a command says of a file with --json."""
    found: dict[str, Any] = json.loads(done(*arguments, "--json").stdout)
    return found


def refused(code: int, *arguments: object, stdin: bytes | None = None) -> str:
    """The one line that a command says which must end with this exit code and print nothing."""
    result = sgi(*arguments, stdin=stdin)
    assert (result.exit_code, result.stdout) == (code, ""), result.output
    assert result.stderr.startswith("sgi: ")
    assert result.stderr.count("\n") == 1, result.stderr
    return result.stderr
