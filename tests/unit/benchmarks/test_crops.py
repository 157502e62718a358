"""Crops lie where they should and are 8-bit RGB."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from click.testing import CliRunner

from benchmarks.crops import along_the_diagonal, main
from sgicodec import Picture, read

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_places_and_depth() -> None:
    pixels = np.random.default_rng(0).integers(0, 65536, (90, 60, 4), np.uint16)
    first, second = along_the_diagonal(Picture(pixels, "multi", (0.0, 65535.0)), 30, 60, 2)
    assert first.channels == "rgb"
    np.testing.assert_array_equal(first.pixels, np.rint(pixels[10:70, 10:40, :3] / 257).astype(np.uint8))
    np.testing.assert_array_equal(second.pixels, np.rint(pixels[20:80, 20:50, :3] / 257).astype(np.uint8))


def test_the_command_names_them(tmp_path: Path) -> None:
    CliRunner().invoke(main, [str(tmp_path), str(PHOTO), "--width", "64", "--height", "48"], catch_exceptions=False)
    whole, crop = read(PHOTO), read(tmp_path / "kodim23-1.png")
    x, y = round(2 / 3 * (whole.width - 64)), round(2 / 3 * (whole.height - 48))
    np.testing.assert_array_equal(crop.pixels, whole.pixels[y : y + 48, x : x + 64])
