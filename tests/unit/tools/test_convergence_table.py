"""The course of a fit, from one real fit in a few steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec.device import ONE_THREAD
from sgicodec.rate_control.convergence import DONE
from tools.convergence_table import followed

PICTURE = Path(__file__).parents[2] / "data" / "pictures" / "hopper_gray.jpg"


def test_forecasts_come_nearer_to_the_outcome() -> None:
    course = followed(PICTURE, 0.006, 60, ONE_THREAD)
    ratio, lift = course.ratio, course.lift
    assert len(ratio) == len(lift) == len(DONE)
    assert ratio[0] > 1.2
    assert ratio[-1] == pytest.approx(1.0, abs=0.15)
    assert lift[-1] == pytest.approx(0.0, abs=0.3)
    assert abs(lift[-1]) < np.abs(lift[1:5]).min()
    assert course.share < 1.0 or course.gain > 0.0
