"""Standard streams that are closed or full, names that are too long, address space that is too small."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from children import HANGS
from command import refused

FULL = Path("/dev/full")
needs_full = pytest.mark.skipif(not FULL.exists(), reason="there is no /dev/full here")


def closing(*numbers: int) -> Callable[[], None]:
    def close() -> None:
        for number in numbers:
            os.close(number)

    return close


def run(*arguments: object, before: Callable[[], None] | None = None, **streams: object) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a command; `before` runs in its process first."""
    command = [sys.executable, "-m", "sgicodec", *map(str, arguments)]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams
    done = subprocess.run(command, preexec_fn=before, timeout=HANGS, check=False, **pipes)  # type: ignore[call-overload]
    return done.returncode, (done.stdout or b"").decode(), (done.stderr or b"").decode()


@pytest.mark.parametrize("numbers", [(1,), (2,), (0, 1, 2)])
def test_an_encode_without_standard_streams(picture: Path, numbers: tuple[int, ...]) -> None:
    """OUT is whole, and nothing that was meant for a closed stream is in it."""
    status, _, errors = run("encode", picture, "--steps", 2, "-j", 1, "--progress", "on", before=closing(*numbers))
    assert status == 0, errors
    assert "rror" not in errors
    assert run("verify", picture.with_suffix(".sgi"))[0] == 0


@pytest.mark.parametrize("command", ["encode", "decode", "info", "verify"])
def test_stdin_is_closed(command: str, tmp_path: Path) -> None:
    out = [tmp_path / "x.sgi"] if command == "encode" else [tmp_path / "x.png"] if command == "decode" else []
    status, _, errors = run(command, "-", *out, before=closing(0))
    assert (status, errors) == (2, "sgi: stdin is closed; name IN\n")


@pytest.mark.parametrize("command", ["encode", "decode"])
def test_stdout_is_closed(command: str, picture: Path, stream: Path) -> None:
    status, _, errors = run(command, picture if command == "encode" else stream, "-", before=closing(1))
    assert (status, errors) == (2, "sgi: stdout is closed; name OUT\n")


@needs_full
@pytest.mark.parametrize("arguments", [["info"], ["verify"], ["--help"], ["encode", "--steps", "2", "-j", "1"]])
def test_a_report_that_cannot_be_written(picture: Path, stream: Path, arguments: list[str]) -> None:
    name = {"encode": [picture, "-f"], "--help": []}.get(arguments[0], [stream])
    with FULL.open("wb") as full:
        status, _, errors = run(*arguments, *name, stdout=full)
    assert (status, errors) == (1, "sgi: stdout: No space left on device\n")
    if arguments[0] == "encode":
        assert run("verify", picture.with_suffix(".sgi"))[0] == 0


@pytest.mark.parametrize(("command", "text"), [(["encode", "--tile", 32], "I/O error"), (["encode"], "too large")])
def test_files_that_cannot_grow(picture: Path, command: list[object], text: str) -> None:
    """It is the output that cannot be written, and nothing of it is left."""

    def bound() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))

    status, _, errors = run(*command, picture, "--steps", 2, "-j", 1, "--quiet", before=bound)
    assert (status, errors.count("\n"), text in errors) == (3, 1, True), errors
    assert list(picture.parent.iterdir()) == [picture]


@pytest.mark.parametrize("length", [300, 5000])
def test_names_that_are_too_long(picture: Path, stream: Path, length: int) -> None:
    long = picture.parent / ("a" * length)
    for arguments, status in (
        (["encode", picture, f"{long}.sgi"], 2),
        (["encode", f"{long}.png", picture.parent / "x.sgi"], 3),
        (["decode", stream, f"{long}.png"], 2),
        (["decode", f"{long}.sgi", picture.parent / "x.png"], 4),
        (["info", f"{long}.sgi"], 4),
    ):
        line = refused(status, *arguments)
        assert line.startswith(f"sgi: {long}")
        assert line.endswith(": File name too long\n")


def within(mebibytes: int) -> Callable[[], None]:
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (mebibytes << 20,) * 2)


@pytest.mark.skipif(sys.platform != "linux", reason="address space is limited on Linux alone")
@pytest.mark.parametrize("mebibytes", [64, 96, 112, 144, 180, 210])
def test_little_address_space(picture: Path, stream: Path, mebibytes: int) -> None:
    """Libraries that load would end the process, some without a word."""
    for arguments in (
        ["encode", picture, "-f", "-j", 1, "--steps", 2],
        ["decode", stream, picture.parent / "x.tga", "-f"],
    ):
        status, _, errors = run(*arguments, before=within(mebibytes))
        if status:
            assert status == 1
            assert errors.startswith("sgi: there is not enough memory"), errors
            assert errors.count("\n") == 1
    assert mebibytes >= 180 or status == 1
