"""The levels of a pyramid."""

from __future__ import annotations

from sgicodec.decoder.levels import levels_of


def test_each_is_half_of_the_one_before() -> None:
    assert [level[:2] for level in levels_of(2000, 900)] == [(2000, 900), (1000, 450), (500, 225), (250, 112)]
    assert [round(level.downsample, 2) for level in levels_of(2048, 1024)] == [1, 2, 4, 8]


def test_a_small_picture_has_one() -> None:
    assert levels_of(256, 1) == ((256, 1, 1.0),)
    assert levels_of(100_000, 1)[-1][:2] == (195, 1)
