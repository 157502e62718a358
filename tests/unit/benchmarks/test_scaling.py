"""The benchmark of sizes: what it derives from its points, and that it runs."""

from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import scaling
from benchmarks.scaling import Point, crop_of, exponent, fit_memory, main, read_points, write_points
from sgicodec.image import write
from sgicodec.picture import Picture


def point(megapixels: float, quality: float, **values: float) -> Point:
    side = round(1000 * megapixels**0.5)
    gaussians = round(500 * quality * megapixels)
    ones = dict.fromkeys(scaling.MEASURES, 1.0)
    return Point(quality, side, side, gaussians, 10 * gaussians, **(ones | values))


def test_crops_are_the_middle_and_of_the_same_shape() -> None:
    pixels = np.arange(300 * 200, dtype=np.uint16).reshape(200, 300, 1)
    crop = crop_of(Picture(pixels, "gray", (0.0, 65535.0)), 0.015)
    np.testing.assert_array_equal(crop.pixels, pixels[50:150, 75:225])
    with pytest.raises(click.UsageError, match=r"0\.1 megapixels, fewer than 1"):
        crop_of(crop_of(Picture(pixels, "gray", (0.0, 65535.0)), 0.06), 1)


def test_the_power_of_growth_leaves_small_pictures_out() -> None:
    sizes = (0.25, 1.0, 4.0, 16.0)
    points = [point(s, q, encode_seconds=q * max(s, 1.0) ** 1.3) for s in sizes for q in (30.0, 60.0)]
    assert exponent(points, "encode_seconds") == pytest.approx(1.3, abs=0.01)


def test_the_formula_of_memory_is_found() -> None:
    points = [point(s, q) for s in (0.25, 1.0, 4.0) for q in (30.0, 60.0)]
    known = [point(p.megapixels, p.quality, decode_mib=70 + 9 * p.megapixels + 0.4 * p.gaussians / 1e3) for p in points]
    found = fit_memory(known, "decode_mib")
    assert (found.fixed, found.per_megapixel, found.per_kilo_gaussian) == pytest.approx((70, 9, 0.4), rel=1e-6)
    assert found.error < 1e-6
    shrinking = [point(p.megapixels, p.quality, decode_mib=70 - p.megapixels) for p in points]
    assert fit_memory(shrinking, "decode_mib").per_megapixel == 0


def test_points_survive_their_table(tmp_path: Path) -> None:
    points = [point(1.0, 30.0, encode_seconds=1.25), point(4.0, 60.0, decode_mib=81.5)]
    write_points(points, tmp_path / "x.tsv")
    assert read_points(tmp_path / "x.tsv") == points


def test_the_command_measures_and_reports_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scaling, "SIZES", (0.002, 0.004))
    pixels = np.random.default_rng(0).integers(0, 256, (80, 60, 3)).astype(np.uint8)
    write(Picture(pixels, "rgb", (0.0, 255.0)), tmp_path / "in.png")
    arguments = ["--out", str(tmp_path), "--threads", "1", "--steps", "2"]
    result = CliRunner().invoke(main, [str(tmp_path / "in.png"), *arguments])
    assert result.exit_code == 0, result.output
    table = tmp_path / "results" / "scaling.tsv"
    points = read_points(table)
    assert [(p.width, p.height, p.quality) for p in points] == [(39, 52, 30), (39, 52, 60), (55, 73, 30), (55, 73, 60)]
    assert all(p.gaussians > 0 and p.encode_mib > 10 and p.pixels_seconds > 0 for p in points)
    assert (tmp_path / "images" / "scaling.png").stat().st_size > 10_000
    again = CliRunner().invoke(main, [str(table), *arguments])
    assert again.exit_code == 0, again.output
    tables = [[line.split("|")[1:4] for line in run.stdout.splitlines()[:6]] for run in (result, again)]
    assert tables[0] == tables[1]
    assert len(tables[0][5]) == 3
