"""The commands `bench` and `compare` as a user types them."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from image_files import SRGB
from PIL import Image
from range_server import served

import sgicodec
from sgicodec.bench.command import bench, compare
from sgicodec.errors import OutputExistsError, PictureError, SgiError, StreamError, TargetMissedError, UsageError
from sgicodec.metrics.perceptual import Perceived


def save(path: Path, pixels: np.ndarray) -> Path:
    Image.fromarray(pixels).save(path)
    return path


def picture(height: int = 40, width: int = 56) -> np.ndarray:
    y, x = np.mgrid[:height, :width]
    return np.stack([(3 * x + y) % 200, (x + 2 * y) % 200, (x * y) // 16 % 200], axis=2).astype(np.uint8)


def call(command: object, *arguments: object) -> Result:
    names = ["-h", "--help"]  # as the group has it: click keeps the help option that a command is first invoked with
    return CliRunner().invoke(command, [str(argument) for argument in arguments], help_option_names=names)


def test_bench_prints_tables_and_leaves_results(tmp_path: Path) -> None:
    source = save(tmp_path / "p.png", picture())
    result = call(bench, source, "--codecs", "webp,jpeg", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.exception
    assert "BD-rate in % against jpeg of" in result.stdout
    assert "1/1 p.png 56x40: 18 points measured, 0 already there" in result.stderr
    names = {path.name.split("-")[0] for path in (tmp_path / "out").iterdir()}
    assert names == {"results.tsv", "summary.json", "rd", "time.png"}


def test_bench_resumes_and_prints_json(tmp_path: Path) -> None:
    source = save(tmp_path / "p.png", picture())
    arguments = (source, "--codecs", "jpeg", "--out", tmp_path / "out", "--no-plots", "--json")
    first, second = call(bench, *arguments), call(bench, *arguments)
    assert "0 points measured, 9 already there" in second.stderr
    told = json.loads(first.stdout)
    assert told == json.loads(second.stdout) == json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (told["schema"], list(told["codecs"])) == (1, ["jpeg"])


def test_bench_leaves_out_aloud_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from sgicodec.bench import run

    seen = {}
    monkeypatch.setattr(
        run, "run_bench", lambda pictures, codecs, out, **others: seen.update(codecs=codecs, **others) or 1 / 0
    )
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    result = call(bench, save(tmp_path / "p.png", picture()))
    assert "left out: jxl needs imagecodecs: pip install 'sgicodec[bench]'" in result.stderr
    present = [codec.name for codec in seen["codecs"]]
    assert present == ["sgi", "jpeg", "jpeg2000", "webp", "avif-iq", "avif-iq-s2", "avif", "avif-s2"]
    assert [curves.name for curves in seen["published"]] == ["coolchic5"]
    asked = call(bench, tmp_path / "p.png", "--codecs", "jpeg,jxl")
    assert isinstance(asked.exception, UsageError)
    assert "pip install 'sgicodec[bench]'" in str(asked.exception)


@pytest.mark.parametrize("command", [bench, compare])
def test_a_missing_extra_is_named_in_one_line(command: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    source = save(tmp_path / "p.png", picture())
    error = call(command, source, source).exception
    assert isinstance(error, UsageError)
    assert str(error) == f"sgi {command.name} needs scipy: pip install 'sgicodec[bench]'"  # type: ignore[attr-defined]


def test_bench_ends_with_an_error_if_a_point_failed(tmp_path: Path) -> None:
    wide = save(tmp_path / "wide.png", np.zeros((1, 17000, 3), np.uint8))
    result = call(bench, wide, "--codecs", "jpeg,webp", "--out", tmp_path / "out", "--no-plots", "--json")
    assert isinstance(result.exception, SgiError)
    assert "9 points failed, the first of them: wide.png, webp, quality=0" in str(result.exception)
    assert len(json.loads(result.stdout)["failures"]) == 9


@pytest.mark.parametrize("options", [["--no-plots"], ["--lossless"]])
def test_bench_says_what_it_cannot_write(tmp_path: Path, options: list[str]) -> None:
    source = save(tmp_path / "p.png", picture())
    error = call(bench, source, "--codecs", "webp", "--out", source, *options).exception
    assert isinstance(error, PictureError)
    assert str(error) == f"{source}: File exists"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--codecs", "jpeg,bpg"], "no codec is called 'bpg'"),
        (["--lossless", "--codecs", "jpeg"], "no codec is called 'jpeg'; there are sgi, png"),
        (["--qualities", "20,high"], "--qualities takes numbers"),
        (["--efforts", "max"], "--efforts takes numbers"),
        (["--sgi", "--tile 64"], "--sgi takes NAME=OPTIONS"),
        (["--sgi", "fine='"], "--sgi: No closing quotation"),
        ([""], "the name of a picture or folder is empty"),
    ],
)
def test_bench_refuses_what_makes_no_sense(tmp_path: Path, arguments: list[str], complaint: str) -> None:
    save(tmp_path / "p.png", picture())
    result = call(bench, tmp_path, "--out", tmp_path / "out", *arguments)
    assert isinstance(result.exception, UsageError)
    assert complaint in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_compare_prints_the_figures(tmp_path: Path) -> None:
    a = save(tmp_path / "a.png", picture())
    b = save(tmp_path / "b.png", picture() + np.uint8(5))
    lines = call(compare, a, b).stdout.splitlines()
    expected = f"{20 * math.log10(255 / 5):.3f} dB"
    known = {"ssimulacra2": "SSIMULACRA", "butteraugli": "Butteraugli", "flip": "FLIP", "cvvdp": "ColorVideoVDP"}
    known |= {"lpips": "LPIPS", "dists": "DISTS"}
    scores = [known[name] for name in Perceived.available()]
    assert [line.split(maxsplit=1)[0] for line in lines] == ["PSNR", "luma", "SSIM", "MS-SSIM", *scores, "largest"]
    assert lines[0].endswith(expected)
    assert lines[1].endswith(expected)
    assert lines[-1] == "largest difference  5"


def test_compare_decodes_streams(tmp_path: Path) -> None:
    a, stream = save(tmp_path / "a.png", picture()), tmp_path / "a.sgi"
    stream.write_bytes(sgicodec.encode(picture(), steps=2))
    decoded = save(tmp_path / "decoded.png", sgicodec.decode(stream.read_bytes()))
    expected = call(compare, a, decoded)
    assert expected.exit_code == 0
    assert call(compare, a, stream).stdout == expected.stdout
    assert call(compare, stream, decoded).stdout.splitlines()[-1] == "largest difference  0"
    with served({"a.sgi": stream.read_bytes()}) as server:
        assert call(compare, a, f"{server.url}/a.sgi").stdout == expected.stdout
    stream.write_bytes(stream.read_bytes()[:-9])
    damaged = call(compare, a, stream).exception
    assert isinstance(damaged, StreamError)
    assert str(damaged).startswith(f"{stream}: ")
    named_so = tmp_path / "silicon.sgi"
    named_so.write_bytes((Path(__file__).parents[2] / "data" / "pictures" / "hopper.sgi").read_bytes())
    assert call(compare, named_so, named_so).exit_code == 0


def test_compare_draws_the_error(tmp_path: Path) -> None:
    changed = picture()
    changed[3, 4] += np.array([0, 2, 20], np.uint8)
    a, b = save(tmp_path / "a.png", picture()), save(tmp_path / "b.png", changed)
    target = tmp_path / "map.png"
    assert call(compare, a, b, "--map", target, "--gain", "10").exit_code == 0
    drawn = np.asarray(Image.open(target))
    assert drawn[3, 4].tolist() == [128, 148, 255]
    assert (np.delete(drawn.reshape(-1, 3), 3 * 56 + 4, axis=0) == 128).all()
    assert isinstance(call(compare, b, a, "--map", target).exception, OutputExistsError)
    assert isinstance(call(compare, a, b, "--map", b, "-f").exception, UsageError)
    assert call(compare, b, a, "--map", target, "-f").exit_code == 0
    assert np.asarray(Image.open(target))[3, 4].tolist() == [128, 112, 0]


def test_compare_fails_under_a_target(tmp_path: Path) -> None:
    a = save(tmp_path / "a.png", picture())
    b = save(tmp_path / "b.png", picture() + np.uint8(5))
    assert call(compare, a, b, "--fail-under", "34.1").exit_code == 0
    missed = call(compare, a, b, "--fail-under", "34.2")
    assert isinstance(missed.exception, TargetMissedError)
    assert "34.151 dB" in str(missed.exception)
    assert "PSNR" in missed.stdout
    assert call(compare, a, a, "--fail-under", "99").exit_code == 0


def test_compare_refuses_unlike_pictures(tmp_path: Path) -> None:
    a = save(tmp_path / "a.png", picture())
    b = save(tmp_path / "b.png", picture()[:-1])
    assert "differ in size: 56x40 with 3 channels and 56x39" in str(call(compare, a, b).exception)
    gray = save(tmp_path / "gray.png", picture()[..., 0])
    assert "differ in channels: 56x40 with 3 channels" in str(call(compare, a, gray).exception)


def test_compare_tells_of_profiles(tmp_path: Path) -> None:
    plain, first, second = (tmp_path / f"{name}.png" for name in ("plain", "first", "second"))
    save(plain, picture())
    for path, number in ((first, b"1"), (second, b"2")):
        Image.fromarray(picture()).save(path, icc_profile=SRGB[:84] + number * 16 + SRGB[100:])
    assert call(compare, first, first).stderr == ""
    result = call(compare, plain, first, "--json")
    assert result.stderr == "sgi: only one has an ICC profile; samples are compared as they are\n"
    assert json.loads(result.stdout)["schema"] == 1
    assert call(compare, first, second).stderr.startswith("sgi: their ICC profiles differ; ")
