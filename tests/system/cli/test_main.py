"""The group: help, exit codes, and what becomes of every kind of failure."""

from __future__ import annotations

import re
import signal
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import click
import numpy as np
import pytest
from command import done, refused, sgi

from sgicodec import NullListener, __version__
from sgicodec.bitstream.header import FORMAT_VERSION
from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.main import cli
from sgicodec.decoder import stream as decoder
from sgicodec.encoder import pipeline as encoder
from sgicodec.fit.trainer import Progress


def test_help_lists_commands_and_exit_codes() -> None:
    result = done("--help")
    for name in ("encode", "decode", "info", "verify", "compare", "bench", "completion"):
        assert f"\n  {name} " in result.stdout
    codes = [line.split()[0] for line in result.stdout.split("Exit codes:\n")[1].splitlines()]
    assert codes == ["0", "1", "2", "3", "4", "5", "6", "130", "141"]
    assert sgi("-h").stdout == result.stdout


def test_version() -> None:
    assert sgi("--version").stdout == f"sgi {__version__}\n"
    for arguments in (("--version", "-v"), ("-v", "--version"), ("--version", "--verbose")):
        lines = sgi(*arguments).stdout.splitlines()
        assert lines[0] == f"sgi {__version__}"
        assert f"numpy {np.__version__}" in lines[2]
        assert {"pillow", "OpenImageIO"} <= set(lines[2].replace(",", "").split())
        assert {"fsspec", "zarr", "tifffile", "pillow-heif"} <= set(lines[3].replace(",", "").split())
        assert "pytest" not in lines[3]
        assert re.search(r"^instruction set (portable|avx2|avx512), \d+ threads$", lines[4])
        assert lines[5] == f"reads format version {FORMAT_VERSION}"


@pytest.mark.parametrize("command", ["encode", "decode"])
def test_help_is_small_and_help_all_is_not(command: str) -> None:
    small, whole = sgi(command, "--help").stdout, sgi(command, "--help-all").stdout
    for other in (("--help", "-v"), ("-v", "-h"), ("-h", "--verbose")):
        assert sgi(command, *other).stdout == whole
    shown, every = (set(re.findall(r"^  (?:-\w, )?(--[a-z0-9-]+)", text, re.MULTILINE)) for text in (small, whole))
    assert len(shown - {"--verbose", "--help", "--help-all"}) <= 10
    found = cli.get_command(click.Context(cli), command)
    options = [param for param in found.params if isinstance(param, click.Option)]
    assert every == {option.opts[-1] for option in options} | {"--help", "--help-all"}
    assert f"sgi {command} --help-all shows {len(every - shown)} more options." in small
    assert small.count(f"\n  sgi {command} ") == whole.count(f"\n  sgi {command} ") == 3
    assert isinstance(found, HelpfulCommand)
    named = {*found.common, *found.research}
    assert named <= {option.name for option in options}, "names of options that are there"


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["enocde"], "there is no command 'enocde' (did you mean 'encode'?)"),
        (["xyzzy"], "there is no command 'xyzzy'"),
        (["scene.png"], "there is no command 'scene.png' (it is a file; did you mean 'sgi encode scene.png'?)"),
        (["scene.sgi"], "there is no command 'scene.sgi' (it is a file; did you mean 'sgi decode scene.sgi'?)"),
    ],
)
def test_suggestions(shared: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], hint: str) -> None:
    monkeypatch.chdir(shared)
    assert refused(2, *arguments) == f"sgi: {hint}; see sgi --help\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion(shell: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The script asks sgi itself, which answers with commands, options and files."""
    script = sgi("completion", shell).stdout
    assert f"_SGI_COMPLETE={shell}_complete" in script
    answers = {}
    for words in ("sgi enc", "sgi encode --over", "sgi decode pho", "sgi encode --tune v"):
        monkeypatch.setenv("_SGI_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(words.count(" ")))
        with pytest.raises(SystemExit):
            cli([])
        answers[words] = capsys.readouterr().out.split()
    assert list(answers.values()) == [["plain,encode"], ["plain,--overview"], ["file,pho"], ["plain,visual"]]


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["frobnicate"], "sgi"),
        (["--frobnicate"], "sgi"),
        (["decode"], "sgi decode"),
        (["decode", "a", "b", "c"], "sgi decode"),
        (["info", "a", "--frobnicate"], "sgi info"),
    ],
)
def test_usage_errors_are_one_line(arguments: list[str], place: str) -> None:
    assert refused(2, *arguments).endswith(f"; see {place} --help\n")


@pytest.mark.parametrize("verbose", [False, True])
@pytest.mark.parametrize("command", ["info", "compare"])
def test_internal_error(stream: Path, monkeypatch: pytest.MonkeyPatch, verbose: bool, command: str) -> None:
    monkeypatch.setattr(decoder, "open_stream", Mock(side_effect=KeyError("two\nlines")))
    arguments = [command, stream, stream] if command == "compare" else [command, stream, "--survey"]
    result = sgi(*arguments, *(["-v"] if verbose else []))
    assert result.exit_code == 1
    assert ("Traceback" in result.stderr) is verbose
    last = result.stderr.splitlines()[-1]
    assert last == r"sgi: internal error, please report it; -v prints the trace: KeyError: 'two\nlines'"
    assert verbose or result.stderr.count("\n") == 1


def test_out_of_memory(stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decoder.Stream, "picture", Mock(side_effect=MemoryError))
    assert refused(1, "decode", stream) == "sgi: there is not enough memory for this picture\n"


def test_interrupt_leaves_nothing(stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decoder.Stream, "picture", lambda *_, **__: signal.raise_signal(signal.SIGINT))
    result = sgi("decode", stream)
    assert result.exit_code == 130
    assert result.stderr.strip() == "sgi: interrupted"
    assert list(stream.parent.iterdir()) == [stream]


def test_first_interrupt_of_a_fit_ends_it_second_gives_up(picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fit(*_: Any, progress: NullListener, **__: Any) -> None:
        state = Progress(step=3, steps=9, seeds=1, psnr=20.0, bits=0.0)
        assert progress.step(state)
        signal.raise_signal(signal.SIGINT)
        assert not progress.step(state)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(encoder, "encode_picture", fit)
    result = sgi("encode", picture)
    assert result.exit_code == 130
    assert result.stderr.split("\n") == [
        "sgi: interrupted at step 3 of 9; writing what is there",
        "",
        "sgi: interrupted",
        "",
    ]
    assert list(picture.parent.iterdir()) == [picture]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
