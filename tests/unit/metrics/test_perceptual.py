"""Perceptual scores, and what happens without the programs that compute them.

tests/unit/benchmarks/test_scores.py holds SSIMULACRA 2 against its published scale.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
import pytest

from sgicodec.errors import SgiError
from sgicodec.metrics import perceptual
from sgicodec.metrics.perceptual import Perceived, butteraugli, perceived, ssimulacra2

DATA = Path(__file__).parents[2] / "data"
needs_ssimulacra2 = pytest.mark.skipif("ssimulacra2" not in Perceived.available(), reason="not installed")
needs_butteraugli = pytest.mark.skipif("butteraugli" not in Perceived.available(), reason="not installed")


def photo(name: str) -> np.ndarray:
    return np.asarray(pytest.importorskip("PIL.Image").open(DATA / f"{name}.png").convert("RGB"))


def by_jpeg(pixels: np.ndarray, quality: int) -> np.ndarray:
    Image = pytest.importorskip("PIL.Image")
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG", quality=quality, subsampling="4:2:0")
    return np.asarray(Image.open(buffer))


@needs_ssimulacra2
def test_ssimulacra2_is_100_for_equal_pictures_and_less_for_others() -> None:
    pixels = photo("kodim23")
    near, far = (ssimulacra2(pixels, by_jpeg(pixels, quality)) for quality in (90, 30))
    assert ssimulacra2(pixels, pixels) == 100
    assert 80 < near < 95
    assert 30 < far < 60


@needs_butteraugli
def test_butteraugli_is_a_distance() -> None:
    pixels = photo("kodim23")
    near, far = (butteraugli(pixels, by_jpeg(pixels, quality)) for quality in (90, 30))
    assert butteraugli(pixels, pixels) == 0
    # libjxl calls 1 the distance of visually lossless; its 3-norm of a good JPEG lies below, of a poor one above.
    assert 0.2 < near < 1 < far < 5


def test_both_at_once() -> None:
    pixels = photo("kodim23")[:64, :80]
    seen = perceived(pixels, by_jpeg(pixels, 50))
    known = {name for name in ("ssimulacra2", "butteraugli") if getattr(seen, name) is not None}
    assert known == set(Perceived.available())


def test_small_pictures_have_no_score() -> None:
    """Both programs would call any two of them equal."""
    assert perceived(np.zeros((7, 30, 3), np.uint8), np.full((7, 30, 3), 200, np.uint8)) == Perceived(None, None)


def test_what_is_missing_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(perceptual, "find_spec", lambda name: None)
    monkeypatch.setattr(perceptual.shutil, "which", lambda name: None)
    assert Perceived.available() == ()
    assert perceived(photo("kodim23"), photo("kodim23")) == Perceived(None, None)


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
