"""Rate targets: what meets and misses them, and the search for a quality that does, with few streams and drafts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from data_files import ROOT
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec.encoder.settings import EncodeSettings
from sgicodec.rate_control.quality_search import MAX_QUALITY, MAX_STREAMS, MIN_QUALITY, Measure, searched_quality
from sgicodec.rate_control.target import TARGETS, RateTarget


class Streams:
    """Sizes that a quality and a part of chance make, and what was asked for."""

    def __init__(self, per_octave: float = 0.65, at_50: float = 20_000, noise: float = 0.0, draft: float = 1.0) -> None:
        self.per_octave, self.at_50, self.noise, self.draft_ratio = per_octave, at_50, noise, draft
        self.measured, self.drafted = list[float](), list[float]()

    def size(self, quality: float) -> float:
        chance = np.random.default_rng(round(1000 * (quality + 100))).uniform(-1, 1)
        return self.at_50 * 2.0 ** (self.per_octave * (quality - 50) / 8 + self.noise * chance)

    def measure(self, quality: float) -> float:
        self.measured.append(quality)
        return self.size(quality)

    def draft(self, quality: float) -> float:
        self.drafted.append(quality)
        return self.draft_ratio * self.size(quality)


@pytest.mark.parametrize("wanted", [3_000, 15_000, 20_000, 26_000, 200_000])
@pytest.mark.parametrize("per_octave", [0.45, 0.65, 0.9])
def test_drafts_leave_few_streams_to_make(wanted: float, per_octave: float) -> None:
    streams, target = Streams(per_octave, draft=1.05), RateTarget("bytes", wanted)
    quality = searched_quality(target, streams.measure, streams.draft)
    assert target.is_met(streams.size(quality))
    assert len(streams.measured) <= 3
    assert len(streams.drafted) <= 3
    alone = Streams(per_octave)
    assert target.is_met(alone.size(searched_quality(target, alone.measure)))
    assert len(alone.measured) <= 6


@settings(max_examples=examples(100))
@given(st.floats(500, 1e6), st.floats(0.2, 1.5), st.floats(0, 0.1), st.floats(0.7, 1.4))
def test_the_end_is_the_nearest_stream_that_does_not_miss(
    wanted: float, per_octave: float, noise: float, draft: float
) -> None:
    streams, target = Streams(per_octave, noise=noise, draft=draft), RateTarget("bytes", wanted)
    quality = searched_quality(target, streams.measure, streams.draft)
    sizes = {at: streams.size(at) for at in streams.measured}
    assert quality in sizes
    assert 1 <= len(streams.measured) == len(sizes) <= MAX_STREAMS
    assert all(MIN_QUALITY <= at <= MAX_QUALITY for at in [*streams.measured, *streams.drafted])
    sound = [at for at in sizes if not target.is_missed(sizes[at])]
    assert target.is_missed(sizes[quality]) == (not sound)
    assert all(abs(target.rate_error(sizes[quality])) <= abs(target.rate_error(sizes[at])) for at in sound)


@pytest.mark.parametrize(("wanted", "end"), [(1.0, MIN_QUALITY), (1e12, MAX_QUALITY)])
def test_what_no_quality_has_ends_at_the_last_one(wanted: float, end: float) -> None:
    streams = Streams()
    assert searched_quality(RateTarget("bytes", wanted), streams.measure, streams.draft) == end


def test_it_ends_early_with_one_stream() -> None:
    def ends(measure: Measure, draft: Measure | None) -> float:
        return searched_quality(RateTarget("bytes", 1000.0), measure, draft, lambda: True)

    streams = Streams()
    ends(streams.measure, streams.draft)
    assert (len(streams.drafted), len(streams.measured)) == (0, 1)


@pytest.mark.parametrize(
    ("target", "value"),
    [
        (RateTarget("bytes", 30_000.0), lambda quality: 1000 + 3000 * max(0.0, quality - 60) ** 2),
        (RateTarget("score", 80.0), lambda quality: 40 + quality / 2 if quality < 70 else 15 + 0.6 * quality),
    ],
)
def test_neither_an_end_that_stays_nor_a_fall_holds_the_search_up(target: RateTarget, value: Measure) -> None:
    """Sizes that hardly move below a quality, and jump behind it; scores that fall once on the way up."""
    streams = Streams()
    streams.size = value  # type: ignore[method-assign]
    assert target.is_met(value(searched_quality(target, streams.measure)))
    assert len(streams.measured) <= MAX_STREAMS


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


def test_every_target_of_the_table_is_a_setting_and_an_option_on_its_page() -> None:
    page = (ROOT / "docs" / "cli.md").read_text()
    for name, target in TARGETS.items():
        assert f"| `--{name}` {target.metavar} |" in page
        rate_target = EncodeSettings(**{name: 2.0}).rate_target(4000)  # type: ignore[arg-type]
        assert rate_target == RateTarget(target.quantity, 1000.0 if target.per_pixel else 2.0)
