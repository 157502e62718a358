"""Contact sheets: what their panels hold, and which places they show."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from click.testing import CliRunner
from PIL import Image

from benchmarks._places import busiest, most_different
from benchmarks.sheets import main


def picture() -> np.ndarray:
    """Gray, with grain in one place."""
    pixels = np.full((160, 240, 3), 90, np.uint8)
    pixels[64:96, 128:176] += np.random.default_rng(1).integers(0, 120, (32, 48, 3), np.uint8)
    return pixels


def test_places_are_where_there_is_detail_and_where_codecs_differ() -> None:
    pixels = picture()
    assert busiest(pixels, 48, 32) == (128, 64)
    other = pixels.copy()
    other[16:32, 24:40] += 40
    assert most_different(pixels, [pixels, other], 16, 16) == (24, 16)


def test_a_sheet_shows_the_original_and_each_codec_at_a_place(tmp_path: Path) -> None:
    pixels = picture()
    Image.fromarray(pixels).save(tmp_path / "p.png")
    options = ["--codecs", "jpeg,webp", "--rates", "1.5", "--place", "50", "9", "--out", str(tmp_path / "sheets")]
    result = CliRunner().invoke(main, [str(tmp_path / "p.png"), *options])
    assert result.exit_code == 0, result.output
    (path,) = (tmp_path / "sheets").iterdir()
    assert path.name.endswith("-1.5bpp.png")
    sheet = np.asarray(Image.open(path))
    doubled = pixels[9:137, 50:210].repeat(2, axis=0).repeat(2, axis=1)
    top, step = 36 + 30 + 36, 320 + 6
    assert np.array_equal(sheet[top : top + 256, 6:326], doubled)
    for panel in (1, 2):
        shown = sheet[top : top + 256, 6 + panel * step : 326 + panel * step].astype(int)
        assert 0 < np.abs(shown - doubled).mean() < 20
