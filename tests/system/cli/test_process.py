"""What only a process of its own shows: signals, pipes, and what is imported."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from children import HANGS

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
        assert process.stdin is not None
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


def test_a_cluster_cannot_read_a_pipe(shared: Path, tmp_path: Path) -> None:
    process = start("encode", "/dev/fd/0", tmp_path / "x.sgi", "--tile", 32, "--cluster", "local:1", "--quiet")
    _, errors = process.communicate((shared / "scene.png").read_bytes(), timeout=HANGS)
    assert process.returncode == 2
    assert b"/dev/fd/0, which is no file; add --send-pixels" in errors


@pytest.mark.parametrize("arguments", [["decode", "-", "--scale", "20", "--format", "ppm"], ["info"]])
def test_reader_of_a_pipe_goes_away(stream: Path, arguments: list[str]) -> None:
    command, *options = arguments
    process = start(command, stream, *options)
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
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
    assert process.stdin is not None
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
