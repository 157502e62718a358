"""The table of pictures with alpha, of a small one."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from click.testing import CliRunner
from PIL import Image

from benchmarks.alpha import least_score, main, over


def test_what_is_seen() -> None:
    pixels = np.array([[[200, 100, 0, 255], [200, 100, 0, 0], [200, 100, 0, 51]]], np.uint8)
    assert over(pixels, 255).tolist() == [[[200, 100, 0], [255, 255, 255], [244, 224, 204]]]
    assert over(pixels, 0)[0, 1].tolist() == [0, 0, 0]


def test_a_row(tmp_path: Path) -> None:
    y, x = np.mgrid[:48, :64]
    pixels = np.stack([4 * x, 5 * y, x + y, np.where(np.hypot(x - 30, y - 24) < 18, 255, 0)], axis=2).astype(np.uint8)
    hidden = pixels.copy()
    hidden[pixels[..., 3] == 0, :3] = 9
    assert least_score(pixels, hidden) == 100
    Image.fromarray(pixels).save(tmp_path / "disc.png")
    result = CliRunner().invoke(main, [str(tmp_path / "disc.png"), "--qualities", "40"], catch_exceptions=False)
    number = r"[\d,]+ -?[\d.]+"
    assert re.fullmatch(
        rf"\| disc \(64×48\) \| {number} \| {number} \| [\d,]+; [\d,]+ \|", result.output.splitlines()[2]
    )
