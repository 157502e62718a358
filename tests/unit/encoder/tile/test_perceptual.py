"""Steps of texture that follow a score to the mean of pictures of a quality."""

from __future__ import annotations

import pytest

from sgicodec.encoder.tile.perceptual import CalibratedSteps


def test_steps_of_texture_become_finer_where_the_score_is_too_low() -> None:
    steps = CalibratedSteps(57.0, 400, passes=5)
    assert steps.after(None) == 400
    low = steps.after(60.0)
    assert 390 < low < 400
    assert steps.after(66.0) == low  # near enough, with what is still to come
    assert steps.after(80.0) > low + 9
    assert steps.after(66.0) == steps.step
    assert steps.after(20.0) == steps.step  # the last pass keeps its steps


def test_steps_move_so_far_and_no_farther() -> None:
    steps = CalibratedSteps(57.0, 400, passes=8)
    assert [steps.after(95.0) for _ in range(3)] == [432] * 3
    assert [steps.after(-90.0) for _ in range(3)] == [368] * 3


@pytest.mark.parametrize("passes", [1, 2])
def test_few_passes_move_steps_once(passes: int) -> None:
    steps = CalibratedSteps(57.0, 400, passes)
    first = steps.after(60.0)
    assert first < 400
    assert steps.after(60.0) == first


def test_without_a_look_steps_stay() -> None:
    assert CalibratedSteps(None, 400, passes=5).after(20.0) == 400
