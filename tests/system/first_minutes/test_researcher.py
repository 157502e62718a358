"""The first minutes of a researcher: curves beside other codecs, the paper's profile and one of its tables."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import sgicodec

ROOT = Path(__file__).resolve().parents[3]

pytestmark = pytest.mark.slow


@pytest.fixture
def pictures(tmp_path: Path) -> Path:
    """Two small pictures in the researcher's folder."""
    for name, top in (("kodim13", 300), ("kodim23", 150)):
        pixels = sgicodec.read(ROOT / "tests" / "data" / f"{name}.png").pixels[top : top + 160, 100:340]
        Image.fromarray(pixels).save(tmp_path / f"{name}.png")
    return tmp_path


def run(folder: Path, *command: str, clone: bool = False) -> str:
    """What a command prints; clone: of a researcher who stands in the repository."""
    environment = {"HOME": str(folder), "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    place = ROOT if clone else folder
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_curves_beside_other_codecs(pictures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    started = time.monotonic()
    options = ("--codecs", "sgi,jpeg,webp", "--efforts", "1", "--qualities", "20,35,50,65", "--out", "out")
    run(pictures, "sgi", "bench", "kodim13.png", "kodim23.png", *options)
    seconds = time.monotonic() - started
    summary = json.loads((pictures / "out" / "summary.json").read_text("utf-8"))
    assert all((pictures / "out" / name).is_file() for name in ("results.tsv", "rd-mean.png", "time.png"))
    text = json.dumps(summary)
    assert "bd_rate" in text
    assert "jpeg" in text
    with capsys.disabled():
        print(f"\n  researcher: curves of three codecs on two pictures in {seconds:.1f} s")


def test_the_paper(pictures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The published method, and where its bytes go under the paper's names; then its tables, in small."""
    options = ("--profile", "paper", "--seeds", "150", "--steps", "300")
    run(pictures, "sgi", "encode", "kodim23.png", "kodim23.sgi", *options)
    survey = run(pictures, "sgi", "info", "kodim23.sgi", "--survey")
    assert re.search(r"seeds +150 × 10 = 1,500 Gaussians", survey)
    for part in ("x_a", "f_a", "s_o, s_a", "δ", "H ", "MLPs"):
        assert part in survey
    run(pictures, "sgi", "decode", "kodim23.sgi", "decoded.png")
    printed = run(pictures, "sgi", "compare", "kodim23.png", "decoded.png")
    stated = float(re.findall(r"^PSNR +([\d.]+) dB", printed, re.MULTILINE)[0])
    pair = [np.asarray(Image.open(pictures / name)).astype(float) for name in ("kodim23.png", "decoded.png")]
    assert abs(stated - 10 * math.log10(255**2 / np.mean((pair[0] - pair[1]) ** 2))) < 0.001
    started = time.monotonic()
    photo = str(pictures / "kodim23.png")
    tables = run(pictures, "python", "-m", "benchmarks", "paper", photo, "--quick", "--table", "lambda", clone=True)
    assert "0.001" in tables
    with capsys.disabled():
        print(f"\n  researcher: a table of the paper, in small, in {time.monotonic() - started:.1f} s")
