"""The ladder of each profile, and which one options choose."""

from __future__ import annotations

import pytest

from sgicodec.bench.ladders import LADDERS, QUALITIES, ladder_of, profile_of
from sgicodec.profiles import PROFILES


def test_every_profile_has_one_by_rising_rate() -> None:
    assert set(LADDERS) == set(PROFILES)
    assert all(list(ladder.values) == sorted(set(ladder.values)) for ladder in LADDERS.values())
    assert {name for name, ladder in LADDERS.items() if ladder.has_efforts} == {
        name for name, profile in PROFILES.items() if "quality" in profile.scales
    }


@pytest.mark.parametrize(
    ("options", "profile"),
    [
        ((), "default"),
        (("--steps", "9"), "default"),
        (("--profile", "paper"), "paper"),
        (("--profile=paper", "--tile", "64"), "paper"),
        (("--profile", "paper", "--profile=default"), "default"),
        (("--profile",), ""),
    ],
)
def test_options_choose_a_profile(options: tuple[str, ...], profile: str) -> None:
    assert profile_of(options) == profile
    assert ladder_of(options) is LADDERS.get(profile, QUALITIES)


def test_points_become_options() -> None:
    assert QUALITIES.options(32.5, 100) == ("-q", "32.5")
    assert LADDERS["paper"].options(1800, 2048 * 1363) == ("--seeds", "5025")
    assert LADDERS["paper"].options(450, 100) == ("--seeds", "1")
