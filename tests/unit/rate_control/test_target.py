"""Rate targets: what meets them, what misses them, and the rate error."""

from __future__ import annotations

import math

import pytest
from data_files import ROOT

from sgicodec.encoder.settings import EncodeSettings
from sgicodec.rate_control.target import TARGETS, RateTarget


def test_targets_and_what_meets_them() -> None:
    size = RateTarget("bytes", 1000)
    assert [size.is_met(b) for b in (969, 970, 1000, 1001)] == [False, True, True, False]
    assert [size.is_missed(b) for b in (1, 1000, 1001)] == [False, False, True]
    psnr = RateTarget("psnr", 30.0)
    assert [psnr.is_met(p) for p in (29.89, 29.91, 30.09, 30.11)] == [False, True, True, False]
    assert [psnr.is_missed(p) for p in (29.89, 29.91, 60.0, math.inf)] == [True, False, False, False]
    assert size.rate_error(985) == pytest.approx(0.0)
    assert size.rate_error(1200) > 0 > size.rate_error(800)
    assert psnr.rate_error(30.0) == 0.0
    assert 0 < psnr.rate_error(math.inf) < math.inf


def test_the_nearest_is_one_that_does_not_miss_the_target() -> None:
    size = RateTarget("bytes", 1000)
    assert size.nearest([1001, 700, 900, 1300]) == 2
    assert size.nearest([1300, 1001, 1400]) == 1
    psnr = RateTarget("psnr", 30.0)
    assert psnr.nearest([29.8, 33.0, 30.5]) == 2
    assert psnr.nearest([28.0, 29.8, 20.0]) == 1


def test_messages_name_the_target_and_the_stream() -> None:
    assert RateTarget("bytes", 90).miss_message(120).endswith("at most 90 bytes was found; the smallest has 120")
    assert "99 dB" in RateTarget("psnr", 99).miss_message(40.125)
    assert "40.12 dB" in RateTarget("psnr", 99).miss_message(40.125)


def test_scores() -> None:
    score = RateTarget("score", 70.0)
    assert [score.is_met(s) for s in (68.9, 69.1, 70.9, 71.1)] == [False, True, True, False]
    assert [score.is_missed(s) for s in (68.9, 69.1, 90.0)] == [True, False, False]
    assert score.rate_error(78.0) == pytest.approx(1.0)
    assert score.miss_message(61.25).endswith("SSIMULACRA 2 70 was found; the best reaches 61.2")


def test_every_target_of_the_table_is_a_setting_and_an_option_on_its_page() -> None:
    page = (ROOT / "docs" / "cli.md").read_text()
    for name, target in TARGETS.items():
        assert f"| `--{name}` {target.metavar} |" in page
        rate_target = EncodeSettings(**{name: 2.0}).rate_target(4000)  # type: ignore[arg-type]
        assert rate_target == RateTarget(target.quantity, 1000.0 if target.per_pixel else 2.0)
