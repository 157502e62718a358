"""An encode that its caller ends before it is done."""

from __future__ import annotations

from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from data_files import crop

from sgicodec import EncodeSettings, NullListener, Picture, decode, encode_picture
from sgicodec.rdoq import coordinate_descent


@pytest.fixture
def passes(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """λ of each pass of RDOQ that is made."""
    made: list[float] = []
    one_pass = coordinate_descent.descend

    def counted(*given: Any) -> object:
        made.append(given[3])
        return one_pass(*given)

    monkeypatch.setattr(coordinate_descent, "descend", counted)
    return made


@pytest.fixture(scope="module")
def picture() -> Picture:
    return crop("kodim23", np.s_[100:164, 150:246])


@pytest.mark.parametrize("step", [3, None])
def test_no_pass_follows_an_end(picture: Picture, passes: list[float], step: int | None) -> None:
    """Forty passes took a minute after Ctrl-C. It ends the fit at a step, or what comes after it."""
    listener = Mock(wraps=NullListener(), ending=lambda: True, step=lambda at: step is None or at.step < step)
    encoded = encode_picture(picture, EncodeSettings(steps=40), progress=listener, verify=True)
    assert passes == []
    assert encoded.ended_early
    assert encoded.steps == (step or 40)
    assert encoded.psnr is not None
    assert encoded.psnr > 20
    assert np.abs(decode(encoded.data).astype(int) - picture.pixels).mean() < 20
