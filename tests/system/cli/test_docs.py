"""docs/cli.md says what the commands do."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest
from command import sgi, told

from sgicodec.cli.main import cli
from sgicodec.encoder.effort import PLAIN_STEPS, PSNR_STEPS, VISUAL_STEPS, effort_of
from sgicodec.image.formats import FORMATS

TEXT = (Path(__file__).parents[3] / "docs" / "cli.md").read_text("utf-8")
SECTIONS = {part.split(maxsplit=1)[0]: part for part in TEXT.split("\n## sgi ")[1:]}


@pytest.mark.parametrize("command", ["encode", "decode", "view", "serve"])
def test_every_option_is_in_its_table(command: str) -> None:
    rows = re.findall(r"^\| (`-.*?) \|", SECTIONS[command], re.MULTILINE)
    documented = {name for row in rows for name in re.findall(r"`(--?[a-z][a-z0-9-]*)`", row)}
    found = cli.get_command(click.Context(cli), command)
    assert found is not None
    params = [
        param
        for param in found.get_params(click.Context(found, help_option_names=["-h", "--help"]))
        if isinstance(param, click.Option)
    ]
    actual = {name for param in params for name in (*param.opts, *param.secondary_opts)}
    assert documented == actual - {"-h", "--help", "--help-all"}


def test_efforts() -> None:
    rows = [line.split("|")[1:-1] for line in TEXT.splitlines() if re.match(r"\| (effort|steps|passes)\b", line)]
    efforts, plain, psnr, visual, passes = ([int(cell) for cell in row[1:]] for row in rows)
    assert dict(zip(efforts, plain, strict=True)) == PLAIN_STEPS
    assert dict(zip(efforts, psnr, strict=True)) == PSNR_STEPS
    assert dict(zip(efforts, visual, strict=True)) == VISUAL_STEPS
    assert passes == [effort_of(steps, "visual").ascent_passes for steps in visual]


def test_exit_codes() -> None:
    documented = re.findall(r"^\| (\d+) \| (.*?) \|", TEXT, re.MULTILINE)
    helped = re.findall(r"^  (\d+)  +(.*)$", sgi("--help").stdout, re.MULTILINE)
    assert [(code, text.replace("`", "")) for code, text in documented] == helped


def test_formats() -> None:
    row = next(line for line in TEXT.splitlines() if line.startswith("| `--format`"))
    assert re.findall(r"`([a-z0-9]+)`", row) == [holder.extensions[0] for holder in FORMATS]


@pytest.mark.parametrize(("command", "file"), [("encode", "scene.png"), ("info", "scene.sgi")])
def test_json_keys(shared: Path, tmp_path: Path, command: str, file: str) -> None:
    options = [tmp_path / "out.sgi", "--steps", 2] if command == "encode" else []
    keys = told(command, shared / file, *options)
    listed = re.search(r"`--json` prints one object(.*?)\.\s", SECTIONS[command], re.DOTALL)
    assert listed
    assert [
        name
        for name in re.findall(r"`([a-z_]+)`", listed[1])
        if name not in ("paper_parts", "icc", "exif", "xmp", "geo")
    ] == list(keys)
