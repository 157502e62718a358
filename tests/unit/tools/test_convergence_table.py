"""The convergence of one real fit in a few steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec.device import ONE_THREAD
from sgicodec.rate_control.convergence import DONE
from tools.convergence_table import followed

PICTURE = Path(__file__).parents[2] / "data" / "pictures" / "hopper_gray.jpg"


def test_predictions_come_nearer_to_the_outcome() -> None:
    fit = followed(PICTURE, 0.006, 60, ONE_THREAD)
    ratio, offset = fit.ratio, fit.offset
    assert len(ratio) == len(offset) == len(DONE)
    assert ratio[0] > 1.2
    assert ratio[-1] == pytest.approx(1.0, abs=0.15)
    assert offset[-1] == pytest.approx(0.0, abs=0.3)
    assert abs(offset[-1]) < np.abs(offset[1:5]).min()
    assert fit.share < 1.0 or fit.gain > 0.0
