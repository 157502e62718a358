"""The command for a machine with a GPU, run with one whose kernels are compiled for the host."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from fake_cuda import fake_gpu, only_gpu

from benchmarks import _cuda_checks as checks
from benchmarks import cuda
from benchmarks.raster import Scene
from sgicodec import write
from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu
from sgicodec.executors.executor import Executor
from sgicodec.picture import Picture

FEW = Scene(60, 2.0, 90, 70)


def test_everything_in_one_run(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    device, _ = only_gpu(monkeypatch), fake_gpu()
    monkeypatch.setattr(cuda, "device_of", lambda name: device)
    monkeypatch.setattr(cuda, "opened", lambda index: fake_gpu())
    monkeypatch.setattr(cuda, "the_compiler", lambda: type("", (), {"version": "13.0"}))
    monkeypatch.setattr(cuda, "SCENES", (FEW,))
    monkeypatch.setattr(checks, "SMALL", FEW)
    monkeypatch.setattr(checks, "CROP", 24)
    monkeypatch.setattr(cuda, "TILE", 32)
    monkeypatch.setattr(cuda, "ProcessExecutor", lambda workers: Executor())  # the GPU is in this process alone
    monkeypatch.setattr(checks, "J_TOLERANCE", 0.2)  # two fits of eight steps
    monkeypatch.setattr(checks.shutil, "which", lambda name: None)
    monkeypatch.setattr(cuda, "STEPS", 8)
    y, x = np.mgrid[:32, :40]
    pixels = np.stack([x * 6, y * 7, x + y], axis=2).astype(np.uint8)
    write(Picture(pixels, "rgb", (0, 255)), tmp_path / "a.png")
    arguments = ["--steps", "8", "--seeds", "1", "--repeat", "1", "--picture", str(tmp_path / "a.png")]
    done = CliRunner().invoke(cuda.main, arguments, catch_exceptions=False)
    assert done.exit_code == 1  # there is no compute-sanitizer
    lines = dict(line.partition(": ")[::2] for line in done.output.splitlines())
    assert lines.keys() >= {
        "gradients",
        "paper",
        "repeated",
        "images",
        "streams, visual",
        "streams, psnr",
        "large",
        "sanitizer",
    }
    assert lines["images"].endswith("have the processor's samples")
    assert "tiles of 32, 1 at a time" in done.output
    for tune in ("visual", "psnr"):
        assert lines[f"streams, {tune}"].startswith("equal bytes twice; J ")
    assert lines["sanitizer"] == "not run: compute-sanitizer is not on the path"
    assert lines["large"].startswith("not run: give a picture")
    assert re.match(r"\d+\.\d\d s, 8 steps of \d+\.\d{3} ms", lines["fit of 40×32"])
    assert re.search(r"forward, error, backward 1\.000 \(\d+ %\)", done.output)


def test_what_the_sanitizer_looks_at_is_every_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    """But for those of other numbers of channels."""
    device, launched = only_gpu(monkeypatch), set[str]()
    launch = Gpu.launch

    def noted(self: Gpu, kernel: str, *rest: Any) -> None:
        launched.add(kernel)
        launch(self, kernel, *rest)

    monkeypatch.setattr(Gpu, "launch", noted)
    monkeypatch.setattr(cuda, "device_of", lambda name: device)
    monkeypatch.setattr(cuda, "opened", lambda index: fake_gpu())
    monkeypatch.setattr(cuda, "the_compiler", lambda: type("", (), {"version": "13.0"}))
    monkeypatch.setattr(checks, "CROP", 64)
    done = CliRunner().invoke(cuda.main, ["--kernels-alone"], catch_exceptions=False)
    assert [line.split(":")[0] for line in done.output.splitlines()[1:]] == ["gradients", "paper", "images"]
    text = "".join(path.read_text("utf-8") for path in (sources.root() / "cuda").rglob("*.hpp"))
    found = re.findall(r"^ *SGI_KERNEL\((\w+?)(_##C)?,", text, re.MULTILINE)
    assert launched == {f"{name}_3" if channels else name for name, channels in found}
