"""Seconds and bytes of encodes next to another version: here this one, at two efforts."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.pace import Encode, main, rate_changes, started, table
from sgicodec import EncodeSettings, Picture, encode_picture, write

PICTURE, SIZE = Path("a.png"), {Path("a.png"): 0.5}


def _runs(**bytes_of: tuple[int, int]) -> dict[tuple[tuple[str, int], Path, float], list[Encode]]:
    return {
        ((name, 1), PICTURE, quality): [Encode(clock, 2.0, 3.0, size, psnr) for clock in (9.0, 1.0, 1.5)]
        for name, sizes in bytes_of.items()
        for size, quality, psnr in zip(sizes, (40.0, 50.0), (30.0, 33.0), strict=True)
    }


def test_bytes_at_equal_psnr_and_medians_per_megapixel() -> None:
    runs = _runs(other=(1000, 2000), this=(800, 1600))
    assert rate_changes(runs, ("other", 1), ("this", 1)) == pytest.approx([-20.0])
    other, this = table(runs, [("other", 1)], SIZE)[2:]
    assert other == "| other | 1 | 3.00 | 4.00 | 6.00 | +0.0 | +0.0 |"
    assert this == "| this | 1 | 3.00 | 4.00 | 6.00 | -20.0 | -20.0 |"


def test_a_version_encodes_towards_squared_error(tmp_path: Path) -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (24, 32, 3), np.uint8)
    picture, path = Picture(pixels, "rgb", (0.0, 255.0)), tmp_path / "a.png"
    write(picture, path)
    with started(Path(sys.executable)) as version:
        found = version.encode(path, 40.0, 1)
    data = encode_picture(picture, EncodeSettings(quality=40.0, effort=1, tune="psnr")).data
    assert version.tunes
    assert found.bytes == len(data)
    assert min(found.clock, found.processor, found.whole) > 0


@pytest.mark.slow
def test_rows(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    write(Picture(np.random.default_rng(0).integers(0, 256, (24, 32, 3), np.uint8), "rgb", (0.0, 255.0)), path)
    options = ["--efforts", "1,2", "--other-efforts", "1", "--qualities", "40,60"]
    result = CliRunner().invoke(main, [sys.executable, str(path), *options], catch_exceptions=False)
    rows = [line for line in result.output.splitlines() if line.startswith(("| this", "| other"))]
    assert [row.split(" | ")[:2] for row in rows] == [["| other", "1"], ["| this", "1"], ["| this", "2"]]
