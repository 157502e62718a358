"""`--device` of `sgi encode` and `sgi decode`: a GPU that is asked for, or said to be missing in one line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from children import HANGS
from fake_cuda import contexts_in, fake_driver, fake_machine, library
from sanitizer import needs_plain_memory

from sgicodec.cuda import compiler, driver, gpu
from sgicodec.image import read, write
from sgicodec.picture import Picture

Run = Any


@pytest.fixture(autouse=True)
def _found_anew() -> Iterator[None]:
    """Driver, compiler and GPU are looked for once in a process."""
    kept = (driver.the_driver, compiler.the_compiler, gpu.own_gpus, gpu.shared, gpu.machine_code)
    for found in kept:
        found.cache_clear()
    yield
    for found in kept:
        found.cache_clear()


def test_a_fit_on_the_gpu_that_is_there(
    sgi: Run, picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake_driver()
    monkeypatch.setattr(gpu, "compiled", lambda architecture, most: b"for no machine")
    streams = {}
    for name, device in {"a": "cuda", "b": "cuda:0", "auto": "auto", "cpu": "cpu"}.items():
        result = sgi("encode", picture, tmp_path / name, "--steps", 20, "--device", device)
        assert result.exit_code == 0, result.output
        streams[name] = (tmp_path / name).read_bytes()
    assert streams["a"] == streams["b"] == streams["auto"] != streams["cpu"]
    pictures = {}
    for device in ("cuda", "cuda:0", "auto", "cpu"):
        result = sgi("decode", tmp_path / "a", tmp_path / "a.png", "--device", device, "-f")
        assert result.exit_code == 0, result.output
        pictures[device] = read(tmp_path / "a.png").pixels.astype(int)
    assert np.array_equal(pictures["cuda"], pictures["cuda:0"])
    assert np.array_equal(pictures["auto"], pictures["cpu"])
    assert 0 < np.abs(pictures["cuda"] - pictures["cpu"]).max() <= 1
    result = sgi("decode", tmp_path / "a", tmp_path / "b.png", "--device", "cuda:1")
    assert (result.exit_code, result.stderr) == (2, "sgi: no GPU 1: this machine has 1\n")
    result = sgi("encode", picture, tmp_path / "c", "--device", "cuda:1")
    assert (result.exit_code, result.stderr) == (2, "sgi: no GPU 1: this machine has 1\n")


FAKE = "no GPU, but this processor"
"""What the fake driver calls its GPU."""


def test_the_report_says_what_fitted(sgi: Run, picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake_driver()
    monkeypatch.setattr(gpu, "compiled", lambda architecture, most: b"for no machine")
    out, steps = tmp_path / "out.sgi", ("--steps", 4, "--no-texture", "-f")

    def said(*options: object) -> list[str]:
        result = sgi("encode", picture, out, *steps, *options)
        assert result.exit_code == 0, result.output
        return [line for line in result.stdout.splitlines() if "fitted by" in line]

    assert said() == []
    assert said("-v") == ["fitted by the processor"]
    assert said("--device", "cuda") == said("--device", "auto", "--tile", 32, "-j", 1) == [f"fitted by {FAKE}"]
    assert said("--device", "cuda", "--profile", "paper", "--levels", 1, "--seeds", 9) == [f"fitted by {FAKE}"]
    for device in ("cuda", "cuda:0"):
        figures = json.loads(sgi("encode", picture, out, *steps, "--device", device, "--tile", 32, "--json").stdout)
        assert (figures["devices"], figures["fallback"]) == ({FAKE: figures["tiles"]}, None)
    many = tmp_path / "many.tif"
    write(Picture(np.arange(6 * 32 * 32, dtype=np.uint8).reshape(32, 32, 6), "multi", (0, 255)), many)
    result = sgi("encode", many, out, *steps, "--device", "cuda", "--json")
    figures = json.loads(result.stdout)
    assert figures["devices"] == {"processor": 1}
    assert figures["fallback"] == "a GPU fits up to 4 channels, not 6"
    monkeypatch.setattr(driver, "LIBRARY", "libno-such.so")
    driver.the_driver.cache_clear()
    gpu.own_gpus.cache_clear()
    assert said("--device", "auto") == ["fitted by the processor: there was no GPU that could be used"]


@pytest.mark.parametrize(
    ("missing", "complaint"),
    [
        ("driver", "no NVIDIA driver: libno-such.so cannot be loaded"),
        ("compiler", "CUDA needs NVRTC: pip install 'sgicodec[cuda]'"),
    ],
)
def test_what_is_missing(
    missing: str, complaint: str, sgi: Run, picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if missing == "driver":
        monkeypatch.setattr(driver, "LIBRARY", "libno-such.so")
    else:
        fake_driver()
        monkeypatch.setattr(compiler, "_packaged", list)
        monkeypatch.setattr(compiler, "_NAMES", ("libno-such.so",))
    result = sgi("encode", picture, tmp_path / "out", "--steps", 3, "--device", "cuda")
    assert (result.exit_code, result.stderr) == (2, f"sgi: {complaint}\n")
    assert not (tmp_path / "out").exists()
    stream = Path(__file__).parents[2] / "conformance" / "golden" / "rgb8.sgi"
    result = sgi("decode", stream, tmp_path / "out.png", "--device", "cuda")
    assert (result.exit_code, result.stderr) == (2, f"sgi: {complaint}\n")
    assert not (tmp_path / "out.png").exists()
    assert sgi("decode", stream, tmp_path / "out.png").exit_code == 0
    for name, device in (("auto", "auto"), ("cpu", "cpu")):
        assert sgi("encode", picture, tmp_path / name, "--steps", 3, "--device", device).exit_code == 0
    assert np.array_equal(*((tmp_path / name).read_bytes() for name in ("auto", "cpu")))


@pytest.mark.slow
def test_processes_compile_load_and_agree(picture: Path, tmp_path: Path) -> None:
    """As a user has it, with NVRTC and its cache, but for the driver; one process and two make the same bytes."""
    needs_plain_memory()
    pytest.importorskip("nvidia", reason="no NVRTC: pip install nvidia-cuda-nvrtc")
    environment = os.environ | {"LD_LIBRARY_PATH": str(library().parent), "XDG_CACHE_HOME": str(tmp_path)}
    options = ["--device", "cuda", "--tile", "32", "--steps", "10", "--no-texture"]
    for workers in ("1", "2"):
        command = [sys.executable, "-m", "sgicodec", "encode", picture, tmp_path / workers, "-j", workers, *options]
        subprocess.run(command, env=environment, check=True, timeout=HANGS)
    assert (tmp_path / "1").read_bytes() == (tmp_path / "2").read_bytes()
    assert len(list((tmp_path / "sgicodec" / "cuda").iterdir())) == 1


def test_several_gpus_have_a_process_each_and_give_the_bytes_of_one(
    picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No process but the one that looks for GPUs has a context on another than its own."""
    needs_plain_memory()
    contexts = fake_machine(monkeypatch, tmp_path, 2)
    options = ["--tile", "32", "--steps", "10", "--no-texture", "-j", "2"]
    streams = []
    for device in ("cuda", "cuda:1"):
        out = tmp_path / f"{device}.sgi"
        command = [sys.executable, "-m", "sgicodec", "encode", str(picture), str(out), *options, "--device", device]
        subprocess.run(command, check=True, timeout=HANGS)
        streams.append(out.read_bytes())
        found = contexts_in(contexts)
        assert sorted(map(sorted, found.values())) == ([[0], [0], [1]] if device == "cuda" else [[1]])
        for file in contexts.iterdir():
            file.unlink()
    assert streams[0] == streams[1]
