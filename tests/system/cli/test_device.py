"""`--device` of `sgi encode`: a GPU that is asked for, or said to be missing in one line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from command import done, refused
from fake_cuda import fake_driver

from sgicodec.cuda import compiler, driver, gpu


@pytest.fixture(autouse=True)
def _found_anew() -> Iterator[None]:
    """Driver, compiler and GPU are looked for once in a process."""
    kept = (driver.the_driver, compiler.the_compiler, gpu.own_gpus, gpu.machine_code)
    for found in kept:
        found.cache_clear()
    yield
    for found in kept:
        found.cache_clear()


def test_a_fit_on_the_gpu_that_is_there(picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake_driver()
    monkeypatch.setattr(gpu, "compiled", lambda architecture, most: b"for no machine")
    streams = {}
    for name, device in {"a": "cuda", "b": "cuda:0", "auto": "auto", "cpu": "cpu"}.items():
        done("encode", picture, tmp_path / name, "--steps", 20, "--device", device)
        streams[name] = (tmp_path / name).read_bytes()
    assert streams["a"] == streams["b"] == streams["auto"] != streams["cpu"]
    assert refused(2, "encode", picture, tmp_path / "c", "--device", "cuda:1") == "sgi: no GPU 1: this machine has 1\n"


@pytest.mark.parametrize(
    ("missing", "complaint"),
    [
        ("driver", "no NVIDIA driver: libno-such.so cannot be loaded"),
        ("compiler", "CUDA needs NVRTC: pip install 'sgicodec[cuda]'"),
    ],
)
def test_what_is_missing(
    missing: str, complaint: str, picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if missing == "driver":
        monkeypatch.setattr(driver, "LIBRARY", "libno-such.so")
    else:
        fake_driver()
        monkeypatch.setattr(compiler, "_packaged", list)
        monkeypatch.setattr(compiler, "_NAMES", ("libno-such.so",))
    assert refused(2, "encode", picture, tmp_path / "out", "--steps", 3, "--device", "cuda") == f"sgi: {complaint}\n"
    assert not (tmp_path / "out").exists()
    for name, device in (("auto", "auto"), ("cpu", "cpu")):
        done("encode", picture, tmp_path / name, "--steps", 3, "--device", device)
    assert np.array_equal(*((tmp_path / name).read_bytes() for name in ("auto", "cpu")))
