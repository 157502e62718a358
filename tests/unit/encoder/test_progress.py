"""How far an encode has come: honest shares, no step back, no end before the end."""

from __future__ import annotations

import numpy as np
import pytest
from clock import Clock

from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.plan import stream_plan
from sgicodec.encoder.progress import StageClock, stage_weights
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.picture import Picture

WEIGHTS = {"load": 1.0, "fit": 6.0, "search": 2.0, "verify": 1.0}


def begun(clock: Clock) -> StageClock:
    stages = StageClock()
    stages.plan(WEIGHTS)
    clock.now += 1
    stages.begin("fit")
    return stages


def test_a_stage_counts_by_what_it_says(clock: Clock) -> None:
    stages = begun(clock)
    assert stages.fraction == pytest.approx(0.1)
    stages.advance(0.5)
    assert stages.fraction == pytest.approx(0.4)
    clock.now += 7
    assert stages.seconds_left == pytest.approx(8 * 0.6 / 0.4)
    stages.advance(1.0)
    assert stages.fraction == pytest.approx(0.7), "the end of the fit is not the end"


def test_a_silent_stage_counts_by_time_at_the_pace_so_far(clock: Clock) -> None:
    stages = begun(clock)
    clock.now += 13  # seven units in fourteen seconds
    stages.begin("search")
    assert stages.fraction == pytest.approx(0.7)
    clock.now += 2
    assert stages.fraction == pytest.approx(0.8)
    clock.now += 1000
    assert 0.89 < stages.fraction < 0.9
    stages.begin("verify")
    assert stages.fraction == pytest.approx(0.9)
    stages.finish()
    assert (stages.fraction, stages.seconds_left) == (1.0, 0.0)


def test_what_begins_again_shares_what_is_left(clock: Clock) -> None:
    stages = begun(clock)
    stages.begin("search")
    stages.advance(1.0)
    assert stages.fraction == pytest.approx(0.9)
    stages.begin("fit")
    assert stages.fraction == pytest.approx(0.9)
    stages.advance(0.5)
    assert stages.fraction == pytest.approx(0.9 + 0.1 * 3 / 9)
    stages.begin("verify")
    assert stages.fraction == pytest.approx(0.9 + 0.1 * 8 / 9)


def test_it_never_goes_back(clock: Clock) -> None:
    stages = begun(clock)
    stages.advance(0.9)
    seen = stages.fraction
    stages.advance(0.2)
    assert stages.fraction == seen
    stages.begin("unknown")
    assert (stages.name, stages.fraction) == ("fit", seen)


def weights_of(**settings: object) -> dict[str, float]:
    picture = Picture(np.zeros((600, 900, 3), np.uint8), "rgb", (0.0, 255.0))
    return stage_weights(stream_plan(windows_of(picture).shape, EncodeSettings(**settings)))  # type: ignore[arg-type]


def test_weights() -> None:
    plain = weights_of(effort=3)
    assert list(plain) == ["load", "prepare", "fit", "search", "texture", "verify"]
    assert 0.3 < plain["fit"] / sum(plain.values()) < 0.55, "half of the time comes after the fit"
    assert list(weights_of(effort=3, rdoq=False, texture=False)) == ["load", "prepare", "fit", "verify"]
    assert list(weights_of(tile=256)) == ["load", "tiles", "verify"]
    assert list(weights_of(tile=256, size=9000)) == ["load", "tiles", "more passes", "verify"]
