"""Rate targets: what meets them, what misses them, and the rate error."""

from __future__ import annotations

import math

import pytest

from sgicodec.rate_control.target import Measured, RateTarget


def test_targets_and_what_meets_them() -> None:
    size = RateTarget(bytes=1000)
    assert [size.is_met(Measured(b, 0.0)) for b in (969, 970, 1000, 1001)] == [False, True, True, False]
    assert [size.is_missed(Measured(b, 0.0)) for b in (1, 1000, 1001)] == [False, False, True]
    psnr = RateTarget(psnr=30.0)
    assert [psnr.is_met(Measured(1, p)) for p in (29.89, 29.91, 30.09, 30.11)] == [False, True, True, False]
    assert [psnr.is_missed(Measured(1, p)) for p in (29.89, 29.91, 60.0, math.inf)] == [True, False, False, False]
    assert size.rate_error(Measured(990, 0.0)) == pytest.approx(0.0)
    assert size.rate_error(Measured(1200, 0.0)) > 0 > size.rate_error(Measured(800, 0.0))
    assert psnr.rate_error(Measured(1, 30.0)) == 0.0
    assert 0 < psnr.rate_error(Measured(1, math.inf)) < math.inf


def test_the_nearest_is_one_that_does_not_miss_the_target() -> None:
    size = RateTarget(bytes=1000)
    assert size.nearest([Measured(b, 0.0) for b in (1001, 700, 900, 1300)]) == 2
    assert size.nearest([Measured(b, 0.0) for b in (1300, 1001, 1400)]) == 1
    psnr = RateTarget(psnr=30.0)
    assert psnr.nearest([Measured(1, p) for p in (29.8, 33.0, 30.5)]) == 2
    assert psnr.nearest([Measured(1, p) for p in (28.0, 29.8, 20.0)]) == 1


def test_the_best_has_the_fewest_bytes_for_what_it_shows() -> None:
    streams = [Measured(1000, 32.0), Measured(900, 31.95), Measured(860, 31.91), Measured(950, 32.2)]
    assert RateTarget(psnr=32.0).best(streams) == 2
    assert RateTarget(psnr=32.0).best([Measured(1000, 32.05), Measured(999, 31.91)]) == 0
    assert RateTarget(psnr=32.0).best([*streams[3:], Measured(800, 31.0)]) == 0
    assert RateTarget(bytes=960).best([Measured(935, 0), Measured(955, 0), Measured(961, 0)]) == 1


def test_messages_name_the_target_and_the_stream() -> None:
    assert (
        RateTarget(bytes=90)
        .miss_message(Measured(120, 0.0))
        .endswith("at most 90 bytes was found; the smallest has 120")
    )
    assert "99 dB" in RateTarget(psnr=99).miss_message(Measured(1, 40.125))
    assert "40.12 dB" in RateTarget(psnr=99).miss_message(Measured(1, 40.125))
