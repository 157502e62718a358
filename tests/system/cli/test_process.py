"""What only a process of its own shows: signals, pipes, standard streams that are closed or full, too little memory."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from children import HANGS
from command import refused

from sgicodec import decode, read

COMMAND = (sys.executable, "-m", "sgicodec")


def start(*arguments: object, **options: int) -> subprocess.Popen[bytes]:
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    return subprocess.Popen([*COMMAND, *map(str, arguments)], **pipes)


def test_streams_of_both_commands(shared: Path, tmp_path: Path) -> None:
    source = (shared / "scene.png").read_bytes()
    encoded = start("encode", "-", "--steps", 2, "-j", 1)
    data, report = encoded.communicate(source, timeout=HANGS)
    assert encoded.returncode == 0
    assert report.decode().startswith(f"stdout: {len(data):,} bytes, ")
    decoded = start("decode", "-", "-", "--format", "ppm", "--scale", "2")
    ppm, complaints = decoded.communicate(data, timeout=HANGS)
    assert decoded.returncode == 0
    assert complaints.decode().startswith("stdout: 96×64 pixels, rgb, ")
    (tmp_path / "out.ppm").write_bytes(ppm)
    np.testing.assert_array_equal(read(tmp_path / "out.ppm").pixels, decode(data, scale=2))


@pytest.mark.parametrize("kind", ["fifo", "descriptor"])
@pytest.mark.parametrize("tile", [0, 32])
def test_pipes_are_read_once(shared: Path, tmp_path: Path, kind: str, tile: int) -> None:
    """A named pipe, and what a shell makes of <(cat scene.png), give the stream of the file."""
    data, target = (shared / "scene.png").read_bytes(), tmp_path / "x.sgi"
    options = ["--steps", 2, "-j", 1, "--tile", tile, "--quiet"]
    assert start("encode", shared / "scene.png", tmp_path / "file.sgi", *options).wait(HANGS) == 0
    if kind == "fifo":
        os.mkfifo(tmp_path / "in")
        process = start("encode", tmp_path / "in", target, *options)
        (tmp_path / "in").write_bytes(data)
    else:
        process = start("encode", "/dev/fd/0", target, *options)
        process.stdin.write(data)
    _, errors = process.communicate(timeout=HANGS)
    assert process.returncode == 0, errors
    assert target.read_bytes() == (tmp_path / "file.sgi").read_bytes()


@pytest.mark.parametrize("options", [[], ["--pyramid"]])
def test_pipes_are_written(stream: Path, tmp_path: Path, options: list[str]) -> None:
    """What arrives is what the report says."""
    pipe, file = tmp_path / "out.tif", tmp_path / "file.tif"
    assert start("decode", stream, file, *options).wait(HANGS) == 0
    os.mkfifo(pipe)
    process = start("decode", stream, pipe, *options)
    assert pipe.read_bytes() == file.read_bytes()
    report, _ = process.communicate(timeout=HANGS)
    assert f", {file.stat().st_size:,} bytes, " in report.decode()


@pytest.mark.skipif(not Path("/dev/stdout").exists(), reason="there is no /dev/stdout here")
@pytest.mark.parametrize("arguments", [["encode"], ["encode", "--no-verify"], ["encode", "--tile", 32], ["strip"]])
def test_pipes_without_a_name_are_written(picture: Path, stream: Path, arguments: list[object]) -> None:
    """/dev/stdout of a pipe, and what a shell makes of >(cat), are links to what no path leads to."""
    command, *options = arguments
    source, more = (picture, ["--steps", 2, "-j", 1, *options]) if command == "encode" else (stream, [])
    file = picture.with_name("file.sgi")
    assert run(command, source, file, "--quiet", *more)[0] == 0
    process = start(command, source, "/dev/stdout", *more)
    data, errors = process.communicate(timeout=HANGS)
    assert (process.returncode, data) == (0, file.read_bytes()), errors
    assert b"stdout: " in errors


def test_a_cluster_cannot_read_a_pipe(shared: Path, tmp_path: Path) -> None:
    process = start("encode", "/dev/fd/0", tmp_path / "x.sgi", "--tile", 32, "--cluster", "local:1", "--quiet")
    _, errors = process.communicate((shared / "scene.png").read_bytes(), timeout=HANGS)
    assert process.returncode == 2
    assert b"/dev/fd/0, which is no file; add --send-pixels" in errors


@pytest.mark.parametrize("arguments", [["decode", "-", "--scale", "20", "--format", "ppm"], ["info"]])
def test_reader_of_a_pipe_goes_away(stream: Path, arguments: list[str]) -> None:
    command, *options = arguments
    process = start(command, stream, *options)
    process.stdout.close()
    complaint = process.stderr.read()
    assert (process.wait(HANGS), complaint) == (141, b"")


def test_any_locale_and_any_file_name(stream: Path) -> None:
    odd = os.fsencode(stream.parent) + b"/\xff\xe4.sgi"
    os.rename(stream, odd)
    for arguments in ([b"info"], [b"verify"], [b"decode", b"-v", b"--format", b"ppm"]):
        command, *options = arguments
        environment = os.environ | {"PYTHONIOENCODING": "ascii"}
        done = subprocess.run([*COMMAND, command, odd, *options], capture_output=True, env=environment)
        assert (done.returncode, b"sgi:" in done.stderr) == (0, False), done.stderr
    assert os.path.exists(odd[:-3] + b"ppm")
    told = json.loads(subprocess.run([*COMMAND, "info", odd, "--json"], capture_output=True).stdout)
    assert os.fsencode(told["input"]) == odd


def test_interrupt_before_the_fit_writes_nothing(tmp_path: Path) -> None:
    process = start("encode", "-", tmp_path / "out.sgi")
    process.stdin.write(bytes(1 << 21))  # more than a pipe holds: once written, the command is reading
    process.stdin.flush()
    process.send_signal(signal.SIGINT)
    _, complaint = process.communicate(timeout=HANGS)
    assert process.returncode == 130
    assert complaint.split() == [b"sgi:", b"interrupted"]
    assert list(tmp_path.iterdir()) == []


def test_interrupt_of_the_fit_still_writes_a_stream(picture: Path) -> None:
    process = start("encode", picture, "--steps", 1_000_000, "--progress", "on", "-j", 1, "--json")
    assert process.stderr is not None
    seen = b""
    while b" step " not in seen:
        block = os.read(process.stderr.fileno(), 4096)
        assert block, seen
        seen += block
    process.send_signal(signal.SIGINT)
    output, rest = process.communicate(timeout=HANGS)
    assert process.returncode == 0, rest
    told = re.search(rb"sgi: interrupted at step (\d+) of \d+; writing what is there", rest)
    assert told
    figures = json.loads(output)
    assert figures["ended_early"] is True
    assert figures["steps"] == int(told[1]) < 1_000_000
    assert sorted(path.name for path in picture.parent.iterdir()) == ["scene.png", "scene.sgi"]
    assert subprocess.run([*COMMAND, "verify", str(picture.with_suffix(".sgi"))], capture_output=True).returncode == 0


FULL = Path("/dev/full")
needs_full = pytest.mark.skipif(not FULL.exists(), reason="there is no /dev/full here")


def run(*arguments: object, before: Callable[[], None] | None = None, **streams: object) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a command; `before` runs in its process first."""
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams
    command = [*COMMAND, *map(str, arguments)]
    done = subprocess.run(command, preexec_fn=before, timeout=HANGS, check=False, **pipes)  # type: ignore[call-overload]
    return done.returncode, (done.stdout or b"").decode(), (done.stderr or b"").decode()


@pytest.mark.parametrize("numbers", [(1, 2), (2, 3), (0, 3)], ids=["stdout", "stderr", "all"])
def test_an_encode_without_standard_streams(picture: Path, numbers: tuple[int, int]) -> None:
    """OUT is whole, and nothing that was meant for a closed stream is in it."""
    options = ["--steps", 2, "-j", 1, "--progress", "on"]
    status, _, errors = run("encode", picture, *options, before=partial(os.closerange, *numbers))
    assert status == 0, errors
    assert "rror" not in errors
    assert run("verify", picture.with_suffix(".sgi"))[0] == 0


@pytest.mark.parametrize("command", ["encode", "decode", "info", "verify"])
def test_stdin_is_closed(command: str, tmp_path: Path) -> None:
    out = [tmp_path / "x.sgi"] if command == "encode" else [tmp_path / "x.png"] if command == "decode" else []
    status, _, errors = run(command, "-", *out, before=partial(os.close, 0))
    assert (status, errors) == (2, "sgi: stdin is closed; name IN\n")


@pytest.mark.parametrize("command", ["encode", "decode"])
def test_stdout_is_closed(command: str, picture: Path, stream: Path) -> None:
    status, _, errors = run(command, picture if command == "encode" else stream, "-", before=partial(os.close, 1))
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
    bound = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (64, 64))
    status, _, errors = run(*command, picture, "--steps", 2, "-j", 1, "--quiet", before=bound)
    assert (status, errors.count("\n"), text in errors) == (3, 1, True), errors
    assert list(picture.parent.iterdir()) == [picture]


def test_a_copy_of_stdin_that_cannot_grow(shared: Path, tmp_path: Path) -> None:
    """The line names the folder for temporary files, where it lies."""
    bound = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (64, 64))
    with (shared / "scene.png").open("rb") as picture:
        status, _, errors = run("encode", "-", tmp_path / "x.sgi", before=bound, stdin=picture)
    folder = tempfile.gettempdir()
    assert (status, errors) == (3, f"sgi: the picture: it cannot be copied to {folder}: File too large\n")


@pytest.mark.parametrize("limit", [0, 64])
def test_a_picture_that_cannot_grow(stream: Path, limit: int) -> None:
    """It is the picture that cannot be written, not the stream that cannot be read; nothing of it is left."""
    before, target = set(stream.parent.iterdir()), stream.with_name("x.png")
    bound = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit))
    assert run("decode", stream, target, "--scale", 8, before=bound) == (3, "", f"sgi: {target}: File too large\n")
    assert set(stream.parent.iterdir()) == before


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


@pytest.mark.parametrize("command", ["encode", "decode"])
def test_a_working_folder_that_is_gone(command: str, picture: Path, stream: Path, tmp_path: Path) -> None:
    def leave() -> None:
        os.mkdir(tmp_path / "gone")
        os.chdir(tmp_path / "gone")
        os.rmdir(tmp_path / "gone")

    source, name = (picture, "x.sgi") if command == "encode" else (stream, "x.png")
    assert run(command, source, name, before=leave) == (2, "", f"sgi: {name}: No such file or directory\n")


@pytest.mark.skipif(sys.platform != "linux", reason="address space is limited on Linux alone")
@pytest.mark.parametrize("mebibytes", [64, 96, 112, 144, 180, 210])
def test_little_address_space(picture: Path, stream: Path, mebibytes: int) -> None:
    """Libraries that load would end the process, some without a word."""
    bound = partial(resource.setrlimit, resource.RLIMIT_AS, (mebibytes << 20,) * 2)
    for arguments in (
        ["encode", picture, "-f", "-j", 1, "--steps", 2],
        ["decode", stream, picture.parent / "x.tga", "-f"],
    ):
        status, _, errors = run(*arguments, before=bound)
        if status:
            assert status == 1
            assert errors.startswith("sgi: there is not enough memory"), errors
            assert errors.count("\n") == 1
    assert mebibytes >= 180 or status == 1
