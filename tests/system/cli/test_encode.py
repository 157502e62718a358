"""`sgi encode` as a user types it: options, targets and reports."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import done, refused, sgi, told
from image_files import SRGB

from sgicodec import Picture, imread, write
from sgicodec.cli.encode_listener import EncodeListener
from sgicodec.encoder import streams
from sgicodec.metadata.blobs import Metadata
from sgicodec.metrics.psnr import psnr
from sgicodec.profiles.default import lmbda_of_quality


def test_opaque_alpha_is_left_out_and_told(tmp_path: Path, pixels: np.ndarray) -> None:
    alpha = np.full((*pixels.shape[:2], 1), 255, np.uint8)
    source = tmp_path / "x.png"
    write(Picture(np.concatenate([pixels, alpha], axis=2), "rgba", (0.0, 255.0)), source)
    result = sgi("encode", source, "--steps", 5, "--json")
    assert result.stderr == f"sgi: {source}: alpha is opaque everywhere; it is left out\n"
    assert json.loads(result.stdout)["channels"] == "rgb"
    assert sgi("encode", source, "--steps", 5, "--quiet", "-f").stderr == ""


def test_out_is_beside_in_and_the_report_is_true(picture: Path, pixels: np.ndarray) -> None:
    result = done("encode", picture, "--steps", 5)
    target = picture.with_suffix(".sgi")
    size = target.stat().st_size
    expected = psnr(pixels, imread(target))
    assert result.stderr == ""
    assert re.fullmatch(
        rf"{re.escape(str(target))}: {size:,} bytes, {8 * size / (48 * 32):.3f} bpp, PSNR {expected:.2f} dB, "
        r"\d+ Gaussians, \d+\.\d s, \d+ MiB\n",
        result.stdout,
    )


def test_json(picture: Path, tmp_path: Path, pixels: np.ndarray) -> None:
    figures = told("encode", picture, tmp_path / "out.sgi", "--steps", 5, "--quiet")
    size = (tmp_path / "out.sgi").stat().st_size
    assert figures["bytes"] == size
    assert figures["bpp"] == pytest.approx(8 * size / (48 * 32))
    assert sum(figures["parts"].values()) == pytest.approx(size)
    assert (figures["width"], figures["height"], figures["channels"], figures["sample_type"]) == (
        48,
        32,
        "rgb",
        "uint8",
    )
    assert figures["ended_early"] is False
    assert (figures["devices"], figures["fallback"]) == ({"processor": 1}, None)
    assert figures["lmbda"] == pytest.approx(lmbda_of_quality(50))
    assert 1 <= figures["seeds"] == figures["gaussians"]
    assert figures["peak_mib"] > 10
    assert figures["seconds"] > 0
    assert figures["psnr"] == pytest.approx(psnr(pixels, imread(tmp_path / "out.sgi")))


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ([], {"quality": None, "lmbda": None, "effort": 4, "profile": "default", "seed": 0, "metadata": True}),
        (["-q", "73.5"], {"quality": 73.5}),
        (["--quality", "1"], {"quality": 1.0}),
        (["--lmbda", "0.25"], {"lmbda": 0.25}),
        (["-e", "9"], {"effort": 9}),
        (["--psnr", "31.5"], {"psnr": 31.5, "size": None, "bpp": None}),
        (["--bpp", "0.25"], {"bpp": 0.25, "psnr": None}),
        (["--size", "1.5kB"], {"size": 1500.0}),
        (["--effort", "1", "--steps", "7"], {"effort": 1, "steps": 7}),
        (
            ["--profile", "paper", "--seeds", "9", "--per-seed", "3", "--features", "8", "--levels", "2"],
            {"profile": "paper", "seeds": 9, "per_seed": 3, "features": 8, "levels": 2},
        ),
        (["--seed", "11"], {"seed": 11}),
        (["-j", "3"], {"threads": 3}),
        (["--threads", "2"], {"threads": 2}),
        (["--device", "cpu", "-j", "2"], {"threads": 2, "gpu": None}),
        (["--no-metadata"], {"metadata": False}),
    ],
)
def test_options_reach_the_encoder(
    picture: Path, asked: dict[str, Any], options: list[str], expected: dict[str, Any]
) -> None:
    assert refused(1, "encode", picture, *options) == "sgi: stopped\n"
    assert {name: asked[name] for name in expected} == expected


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ("-q high", "is not a number from 1 to 100, as in 90 (visually lossless), 65 (web) or 40 (preview)"),
        ("--psnr 35dB", "is not a number of dB, as in 35"),
        ("--ssimulacra2 good", "is not a SSIMULACRA 2 score, as in 70"),
        ("--bpp 1bpp", "is not a number of bits per pixel, as in 0.5"),
        ("-e fast", "is not a valid integer from 1 to 9, as in 2 (fast)"),
        ("-q 0", "1 to 100"),
        ("-q 101", "1 to 100"),
        ("-q nan", "1 to 100"),
        ("-q 50 --psnr 30", "--quality and --psnr exclude each other"),
        ("--lmbda 1 --bpp 1", "--lmbda and --bpp exclude each other"),
        ("--psnr 0", "positive"),
        ("--psnr nan", "positive"),
        ("--psnr inf", "positive"),
        ("--bpp -1", "positive"),
        ("--bpp inf", "positive"),
        ("--ssimulacra2 100", "ssimulacra2"),
        ("--ssimulacra2 -inf", "ssimulacra2"),
        ("--size 0", "as in 20000, 200kB"),
        ("--profile paper --psnr 30", "default profile"),
        ("--profile paper --tune visual", "not tuned for the eye"),
        ("--psnr 40 --lossless", "exclude each other"),
        ("--max-error nan", "max-error"),
        ("--lmbda -1", "negative"),
        ("--lmbda 1e50", "nor above 1e+18"),
        ("-e 0", "1 to 9"),
        ("-e 10", "1 to 9"),
        ("--profile best", "not one of"),
        ("--profile paper -q 5", "give --lmbda"),
        ("--profile paper -e 5", "give --steps"),
        ("--seeds 5", "add --profile paper"),
        ("--profile paper --levels 5", "1 to 4"),
        ("--profile paper --seeds 0", "at least 1"),
        ("--profile paper --per-seed 0", "1 to 64"),
        ("--steps 0", "at least 1"),
        ("--seed -1", "--seed"),
        ("-j -1", "--threads"),
        ("--range 1,0", "--range"),
        ("--range 0,256", "range of uint8"),
        ("--progress maybe", "not one of"),
        ("--device gpu", "auto, cpu, cuda or cuda:N"),
    ],
)
def test_settings_that_make_no_sense(picture: Path, options: str, complaint: str) -> None:
    line = refused(2, "encode", picture, *options.split())
    assert complaint in line
    assert "float" not in line
    assert not picture.with_suffix(".sgi").exists()


def test_a_size_that_is_missed(picture: Path) -> None:
    """Exit 5, the report as ever, one line of complaint, and the nearest stream, which decodes."""
    target = picture.with_suffix(".sgi")
    result = sgi("encode", picture, "--size", 20, "--steps", 5)
    assert result.exit_code == 5
    assert re.fullmatch(
        rf"sgi: no stream of at most 20 bytes .*; it is written to {re.escape(str(target))}\n", result.stderr
    )
    assert f"{target.stat().st_size:,} bytes" in result.stdout
    done("verify", target)


def test_a_size_that_metadata_exceed(pixels: np.ndarray, tmp_path: Path) -> None:
    source = tmp_path / "a.png"
    write(Picture(pixels, "rgb", (0.0, 255.0), Metadata(icc=SRGB)), source)
    result = sgi("encode", source, "--size", 500, "--steps", 2)
    assert (result.exit_code, result.stderr.count("\n")) == (5, 1)
    assert " of them metadata, which --no-metadata leaves out; it is written to " in result.stderr
    done("encode", source, "--size", 500, "--steps", 2, "--no-metadata", "-f")
    assert "--no-metadata" not in sgi("encode", source, "--psnr", 90, "--steps", 2, "-f").stderr


def test_ctrl_c_on_the_way_to_a_goal(picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first step is the last; what there is, is written, and the code says whether the goal was met."""
    real = EncodeListener.step
    monkeypatch.setattr(EncodeListener, "step", lambda *given: real(*given) and False)
    for goal, value, code in (("--size", 5000, 0), ("--size", 30, 5), ("--psnr", 90, 5)):
        result = sgi("encode", picture, "-f", goal, value, "--steps", 30, "--json")
        assert result.exit_code == code, result.output
        assert json.loads(result.stdout)["steps"] == 1
        assert json.loads(result.stdout)["ended_early"] is True
        done("verify", picture.with_suffix(".sgi"))


def test_no_verify_does_not_decode(picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(streams, "open_stream", lambda *_: 1 / 0)
    assert "PSNR" not in done("encode", picture, "--steps", 2, "--no-verify").stdout
    assert told("encode", picture, "-f", "--steps", 2, "--no-verify")["psnr"] is None


@pytest.mark.parametrize(("mode", "drawn"), [("on", True), ("auto", False), ("off", False)])
def test_progress(picture: Path, mode: str, drawn: bool) -> None:
    result = done("encode", picture, "--steps", 8, "--no-texture", "--progress", mode)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", result.stderr)
    assert bool(re.search(r"step 8 of 8  \d+\.\d+ dB  ~\d+\.\d+ bpp", text)) is drawn
    assert drawn or not result.stderr
