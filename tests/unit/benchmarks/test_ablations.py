"""Rows of the ablation tables: what they vary, and means of real encodes."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.ablations import centre, main, measured, tables
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.image import read
from sgicodec.picture import Picture

PICTURE = Path(__file__).parents[2] / "data" / "pictures" / "hopper_gray.jpg"


def picture(height: int, width: int) -> Picture:
    ramp = np.arange(height * width, dtype=np.uint8).reshape(height, width, 1)
    return Picture(ramp, "gray", (0.0, 255.0))


def test_rows_differ_in_what_the_table_is_about() -> None:
    base = EncodeSettings(steps=9)
    for profile, varied in (
        ("default", {"K": {"per_seed"}, "λ": {"lmbda"}}),
        ("paper", {"K": {"per_seed", "seeds", "features"}, "λ": {"lmbda"}, "M": {"levels"}, "Gaussians": {"seeds"}}),
    ):
        found = tables(profile, 3000, base)
        assert found.keys() == varied.keys()
        for name, rows in found.items():
            settings = [asdict(row) for row in rows.values()]
            assert {key for key in settings[0] if len({row[key] for row in settings}) > 1} == varied[name]
            assert {row["profile"] for row in settings} == {profile}
    for value, row in tables("paper", 3000, base)["K"].items():
        assert row.seeds is not None
        assert row.seeds * int(value) == 3000
        assert row.features == 5 * int(value)


def test_the_middle_of_a_picture() -> None:
    whole = picture(9, 14)
    np.testing.assert_array_equal(centre(whole, 4).pixels, whole.pixels[2:6, 5:9])
    np.testing.assert_array_equal(centre(whole, 12).pixels, whole.pixels[:, 1:13])
    np.testing.assert_array_equal(centre(whole, 99).pixels, whole.pixels)


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_means_over_pictures(profile: str) -> None:
    seeds = {"seeds": 20, "per_seed": 2, "features": 6} if profile == "paper" else {}
    settings = EncodeSettings(profile=profile, steps=8, threads=1, **seeds)  # type: ignore[arg-type]
    pictures = [centre(read(PICTURE), side) for side in (24, 40)]
    one, two = (measured([each], settings) for each in pictures)
    both = measured(pictures, settings)
    assert both.psnr == pytest.approx((one.psnr + two.psnr) / 2)
    assert both.bytes == (one.bytes + two.bytes) / 2
    assert sum(both.parts.values()) == pytest.approx(both.bytes)


def test_the_command_prints_a_table() -> None:
    result = CliRunner().invoke(main, [str(PICTURE), "--steps", "5", "--crop", "20", "--tables", "M"])
    assert result.exit_code == 0, result.output
    lines = result.output.strip().splitlines()
    assert lines[0].startswith("| M | PSNR | bytes | of seeds | seconds | x_a | f_a |")
    assert [line.split(" | ")[0] for line in lines[2:]] == ["| 1", "| 2", "| 3", "| 4"]
