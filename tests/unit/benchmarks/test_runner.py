"""The runner lists every benchmark, and every one has a command."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks.__main__ import BENCHMARKS, main

FOLDER = Path(__file__).parents[3] / "benchmarks"


def test_the_list_has_one_line_for_each() -> None:
    lines = CliRunner().invoke(main, []).output.split("Benchmarks:\n")[1].splitlines()
    assert [line.split(maxsplit=1) for line in lines] == [[name, line] for name, (_, line) in BENCHMARKS.items()]


def test_no_program_is_left_out() -> None:
    modules = {f"benchmarks.{path.stem}" for path in FOLDER.glob("[!_]*.py")}
    modules |= {f"benchmarks.{path.parent.name}.command" for path in FOLDER.glob("*/command.py")}
    assert modules == {module for module, _ in BENCHMARKS.values()}


@pytest.mark.parametrize("name", BENCHMARKS)
def test_each_has_help(name: str) -> None:
    result = CliRunner().invoke(main, [name, "--help"])
    assert result.exit_code == 0, result.output
    assert import_module(BENCHMARKS[name][0]).main.help.split()[0] in result.output


def test_an_unknown_name_is_refused() -> None:
    assert CliRunner().invoke(main, ["nonsense"]).exit_code == 2
