"""The README's figure: what its panels hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from click.testing import CliRunner
from PIL import Image

import sgicodec
from benchmarks.figure import main

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_panels(tmp_path: Path) -> None:
    pixels = np.ascontiguousarray(sgicodec.read(PHOTO).pixels[180:276, 100:228])
    sgicodec.write(sgicodec.Picture(pixels, "rgb", (0.0, 255.0)), tmp_path / "photo.png")
    sgicodec.imwrite(tmp_path / "photo.sgi", pixels, steps=10)
    size = (tmp_path / "photo.sgi").stat().st_size
    options = ["--region", "8", "4", "64", "48", "--zoom", "30", "20"]
    paths = [str(tmp_path / name) for name in ("photo.png", "photo.sgi", "figure.png")]
    result = CliRunner().invoke(main, [*paths, *options])
    assert result.exit_code == 0, result.output
    original, ours, theirs = result.output.splitlines()
    assert original == f"original, {pixels.size:,} bytes"
    assert ours.startswith(f"sgi, {size:,} bytes")
    assert theirs.startswith("AVIF, ")
    sheet = np.asarray(Image.open(tmp_path / "figure.png"))
    assert sheet.shape == (2 * 48 + 28, 3 * 64 + 16, 3)
    assert np.array_equal(sheet[20:68, :64], pixels[4:52, 8:72])
    with sgicodec.open(tmp_path / "photo.sgi") as stream:
        assert np.array_equal(sheet[20:68, 72:136], stream.read()[4:52, 8:72])
        assert np.array_equal(sheet[76:, 72:136], stream.read(region=(30, 20, 4, 3), scale=16))
    assert np.abs(sheet[76:, :64].reshape(3, 16, 4, 16, 3).mean(axis=(1, 3)) - pixels[20:23, 30:34]).mean() < 12
