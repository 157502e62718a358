"""The command for a machine with a GPU, run with one whose kernels are compiled for the host."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from fake_cuda import fake_gpu, only_gpu

from benchmarks import _cuda_checks as checks
from benchmarks import cuda
from benchmarks._cuda_floors import H200, Peak, counts_of, floors, peak_of
from benchmarks.raster import Scene
from sgicodec.cuda import driver, sources
from sgicodec.cuda.gpu import Gpu
from sgicodec.cuda.tiles import MOMENTS
from sgicodec.device import Device
from sgicodec.errors import NoDeviceError, SgiError
from sgicodec.image import write
from sgicodec.picture import Picture
from sgicodec.raster.cuda import CudaRasterizer

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
    monkeypatch.setattr(checks, "J_TOLERANCE", 0.2)  # two fits of eight steps
    monkeypatch.setattr(checks.shutil, "which", lambda name: None)
    monkeypatch.setitem(cuda.PLAIN_STEPS, 5, 8)
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
        "decodes",
        "decode, GPU",
        "decode, processor",
        "rate",
        "streams, visual",
        "streams, psnr",
        "large",
        "sanitizer",
    }
    assert lines["decodes"].endswith("at most 1 level from the processor's pixels")
    assert "graph of all 1.000" in done.output
    assert "tiles of 32, 1 at a time" in done.output
    assert "tiles of 32, 2 at a time" in done.output
    for tune in ("visual", "psnr"):
        assert lines[f"streams, {tune}"].startswith("equal bytes twice; J ")
    assert lines["sanitizer"] == "not run: compute-sanitizer is not on the path"
    assert lines["large"].startswith("not run: give a picture")
    assert lines["rate"].endswith("from float64")
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
    assert [line.split(":")[0] for line in done.output.splitlines()[1:]] == ["gradients", "seeds", "paper", "a stream"]
    text = "".join(path.read_text("utf-8") for path in (sources.root() / "cuda").rglob("*.hpp"))
    found = re.findall(r"^ *SGI_KERNEL\((\w+?)(_##C)?,", text, re.MULTILINE)
    assert launched == {f"{name}_3" if channels else name for name, channels in found}


def test_a_large_picture_is_encoded_by_whole_processes(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    y, x = np.mgrid[:64, :80]
    write(Picture(np.stack([x * 3, y * 4, x + y], axis=2).astype(np.uint8), "rgb", (0, 255)), tmp_path / "a.png")
    cuda.print_large("cpu", str(tmp_path / "a.png"))
    said = capsys.readouterr().out.splitlines()
    for line, target in zip(said, ("31", "36"), strict=True):
        assert re.match(
            rf"large, {target} dB: 0\.0 megapixels in 1 tiles, \d+\.\d s, whole process: \d\d\.\d\d dB", line
        )
    with pytest.raises(SgiError, match=r"encode .* 2$"):
        cuda.print_large("gpu", str(tmp_path / "a.png"))


def test_the_sanitizer_looks_at_the_device_that_was_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    called = list[list[str]]()

    def run(command: list[str], **_: Any) -> Any:
        called.append(command)
        return type("", (), {"returncode": 0, "stdout": ""})

    monkeypatch.setattr(checks.shutil, "which", lambda name: name)
    monkeypatch.setattr(checks.subprocess, "run", run)
    assert checks.check_sanitizer("cuda:2").endswith("clean")
    assert [command[2] for command in called] == ["memcheck", "racecheck", "initcheck", "synccheck"]
    assert all(command[-3:] == ["--kernels-alone", "--device", "cuda:2"] for command in called)


def test_a_gradient_that_is_off_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    device, gradients = only_gpu(monkeypatch), checks._gradients
    monkeypatch.setattr(checks, "CROP", 24)

    def off(*given: Any) -> dict[str, np.ndarray]:
        found = gradients(*given)
        found["context.first"][3:9] *= 1.5
        return found

    pixels = np.random.default_rng(1).integers(0, 256, (24, 24, 3), np.uint8)
    assert checks.check_rate(device, pixels).endswith("from float64")
    monkeypatch.setattr(checks, "_gradients", off)
    with pytest.raises(SgiError, match="bits and gradients are"):
        checks.check_rate(device, pixels)


def test_the_peak_is_that_of_the_device() -> None:
    """4 multiprocessors of 128 lanes at 1 GHz; 512 bits twice a clock of 2 GHz."""
    assert peak_of(fake_gpu()) == Peak(1024e9, 64e9, 256e9)


def test_without_a_gpu_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "LIBRARY", "libno-such.so")
    driver.the_driver.cache_clear()
    result = CliRunner().invoke(cuda.main, [])
    driver.the_driver.cache_clear()
    assert isinstance(result.exception, NoDeviceError)
    assert result.output == ""


def test_a_check_that_fails_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = iter([0.0, 1.0, 2.0])
    gradients = tuple(np.zeros((1, n), np.float32) for n in (2, 3, 3))
    monkeypatch.setattr(cuda, "SCENES", (FEW,))
    monkeypatch.setattr(CudaRasterizer, "error", lambda *_: (next(answers), gradients))
    with pytest.raises(SgiError, match="repeated passes differ"):
        checks.check_repeats(fake_gpu(), FEW)


def test_a_pixel_that_is_two_levels_off_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = {None: 0, 0: 2}
    monkeypatch.setattr(checks, "decode", lambda data, device, **view: np.full((2, 2), shown[device.gpu], np.uint8))
    with pytest.raises(SgiError, match="2 levels from the processor's"):
        checks.check_decodes(Device(gpu=0), b"")


def test_counts_bound_what_kernels_find() -> None:
    counts = counts_of(FEW)
    raster = CudaRasterizer(fake_gpu())
    raster.forward(*FEW.gaussians(), FEW.width, FEW.height)
    assert raster._drawn is not None
    found = raster._drawn[1].found()
    assert 0.7 * counts.pairs <= found <= counts.pairs
    assert counts.tiles == raster._drawn[0].tiles
    assert MOMENTS == 5


def test_floors_print_without_a_gpu(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "SCENES", (FEW,))
    output = CliRunner().invoke(cuda.main, ["--floors"]).output
    assert [line.split("|")[3].strip() for line in output.splitlines()[2:]] == [
        *("prepare, list", "sort", "forward", "backward", "reduce", "**all**"),
    ]
    twice = Peak(*(2 * most for most in H200))
    for part in floors(counts_of(FEW)):
        assert part.milliseconds(H200) == pytest.approx(2 * part.milliseconds(twice))
