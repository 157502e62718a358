"""The command `sgi` that the paper's benchmark runs as a process, run in this one."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from click.testing import CliRunner

pytest.importorskip("PIL")
pytest.importorskip("imagecodecs")
pytest.importorskip("matplotlib")
from benchmarks.paper import measure
from sgicodec.bench.sgi import Run
from sgicodec.cli.main import cli as sgi_command
from sgicodec.errors import SgiError


class InProcess:
    """Takes the place of `run_timed`: the same commands, without starting Python each time."""

    def __init__(self) -> None:
        self.commands: list[list[str]] = []

    def __call__(self, command: Sequence[str]) -> Run:
        module, arguments = command[2], list(command[3:])
        self.commands.append([module, *arguments])
        assert module == "sgicodec"
        done = CliRunner().invoke(sgi_command, arguments)
        if done.exit_code:
            raise SgiError(f"`{module}` failed: {done.output}{done.exception}")
        return Run(1.5, 64.0, 1.25)


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> InProcess:
    """What runs the commands of a measurement, and knows them."""
    found = InProcess()
    monkeypatch.setattr(measure, "run_timed", found)
    return found
