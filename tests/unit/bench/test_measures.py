"""Measures of a row as qualities, and back."""

from __future__ import annotations

import dataclasses
import math

import pytest

from sgicodec.bench.measures import MEASURES
from sgicodec.bench.rows import Row

ROW = Row(
    *("sgi", "1", "q", "p.png", "00000000"),
    **{"width": 8, "height": 8, "quality": 1, "bytes": 1, "bpp": 1, "psnr": 30.0, "luma_psnr": 31.0, "ssim": 0.9},
    **{"ms_ssim": 0.99, "encode_seconds": 1.0, "decode_seconds": 1.0, "memory_mib": None},
    **{"ssimulacra2": 55.0, "butteraugli": 2.0},
)


def test_qualities_rise_and_are_shown_as_people_write_them() -> None:
    qualities = {name: measure.quality(ROW) for name, measure in MEASURES.items()}
    expected = {"psnr": 30, "luma_psnr": 31, "ms_ssim": 20, "ssimulacra2": 55, "butteraugli": -10 * math.log10(2)}
    assert qualities == pytest.approx(expected)
    shown = {name: MEASURES[name].shown(quality) for name, quality in qualities.items()}
    assert shown == pytest.approx({"psnr": 30, "luma_psnr": 31, "ms_ssim": 0.99, "ssimulacra2": 55, "butteraugli": 2})


def test_equal_pictures_are_infinitely_good_where_errors_are_measured() -> None:
    same = dataclasses.replace(ROW, ms_ssim=1.0, butteraugli=0.0)
    assert MEASURES["ms_ssim"].quality(same) == MEASURES["butteraugli"].quality(same) == math.inf


def test_unknown_scores_are_not_numbers() -> None:
    bare = dataclasses.replace(ROW, ms_ssim=math.nan, ssimulacra2=None, butteraugli=None)
    assert all(math.isnan(MEASURES[name].quality(bare)) for name in ("ms_ssim", "ssimulacra2", "butteraugli"))
