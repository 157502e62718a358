"""Perceptual scores, and what happens without the programs that compute them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from data_files import crop

from sgicodec.errors import SgiError
from sgicodec.metrics import perceptual
from sgicodec.metrics.perceptual import Perceived, butteraugli, perceived

PHOTO = crop("kodim23", np.s_[20:181, 60:275]).pixels


def test_small_pictures_have_no_score() -> None:
    """SSIMULACRA 2 and Butteraugli would call any two of them equal."""
    assert perceived(np.zeros((7, 30, 3), np.uint8), np.full((7, 30, 3), 200, np.uint8)) == Perceived()


def test_what_is_missing_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(perceptual, "find_spec", lambda name: None)
    monkeypatch.setattr(perceptual, "network", lambda name: None)
    monkeypatch.setattr(perceptual.shutil, "which", lambda name: None)
    assert Perceived.available() == ()
    assert perceived(PHOTO, PHOTO) == Perceived()


@pytest.mark.parametrize(("name", "best", "more_is_better"), [("flip", 0.0, False), ("cvvdp", 10.0, True)])
def test_a_worse_picture_has_a_worse_value(name: str, best: float, more_is_better: bool) -> None:
    if name not in Perceived.available():
        pytest.skip(f"{name} is not installed")
    measure, noise = getattr(perceptual, name), np.random.default_rng(0).normal(0.0, 1.0, PHOTO.shape)
    values = [measure(PHOTO, np.clip(np.rint(PHOTO + s * noise), 0, 255).astype(np.uint8)) for s in (0, 4, 16)]
    assert values[0] == pytest.approx(best, abs=1e-3)
    assert values == sorted(values, reverse=more_is_better)
    assert len(set(values)) == 3


def test_colour_counts_for_flip() -> None:
    """It is no measure of luma: red for blue of about the same luma is a large difference."""
    pytest.importorskip("flip_evaluator")
    red, gray = np.empty((64, 64, 3), np.uint8), np.full((64, 64, 3), 76, np.uint8)
    red[:] = (255, 0, 0)
    assert perceptual.flip(red, gray) > 0.5


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script with a shebang")
@pytest.mark.parametrize(
    ("prints", "status", "message"),
    [("0.5\\n3-norm: 0.25", 0, None), ("0.5", 0, "no 3-norm"), ("3-norm: 1", 1, "butteraugli_main failed")],
)
def test_butteraugli_reads_what_the_command_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, prints: str, status: int, message: str | None
) -> None:
    command = tmp_path / "butteraugli_main"
    checks = "import sys; assert open(sys.argv[1], 'rb').read().startswith(b'P6 9 8 255\\n')"
    command.write_text(f"#!{sys.executable}\n{checks}\nprint('{prints}')\nsys.exit({status})\n")
    command.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    pixels = np.zeros((8, 9, 3), np.uint8)
    if message is None:
        assert butteraugli(pixels, pixels) == 0.25
    else:
        with pytest.raises(SgiError, match=message):
            butteraugli(pixels, pixels)
