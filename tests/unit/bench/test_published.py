"""Published curves: on the pictures they belong to, and on no other."""

from __future__ import annotations

import math

import pytest

from sgicodec.bench.published import PUBLISHED

CURVES = PUBLISHED["coolchic5"]


def test_a_kodak_picture_has_its_points() -> None:
    rows = CURVES.rows("kodim13.png", "0f", 768, 512)
    assert [row.key for row in rows] == [("coolchic5", "published", row.settings, "kodim13.png", "0f") for row in rows]
    assert [row.psnr for row in rows] == sorted(row.psnr for row in rows)
    assert all(row.bytes * 8 / (768 * 512) == pytest.approx(row.bpp, rel=1e-3) for row in rows)
    assert all(math.isnan(row.ms_ssim) and row.ssimulacra2 is None for row in rows)
    upright = CURVES.rows("kodim19.png", "0f", 512, 768)
    assert len(upright) == len(rows) == 5


def test_all_24_pictures_are_there_and_rise() -> None:
    for number in range(1, 25):
        rates = [row.bpp for row in CURVES.rows(f"kodim{number:02}.png", "0f", 768, 512)]
        assert rates == sorted(rates)
        assert 0.02 < rates[0] < 0.3 < rates[-1] < 3


@pytest.mark.parametrize(("name", "width"), [("kodim25.png", 768), ("kodim13-0.png", 768), ("kodim13.png", 767)])
def test_no_other_picture_has_any(name: str, width: int) -> None:
    assert CURVES.rows(name, "0f", width, 512) == []
