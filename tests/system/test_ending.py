"""An encode that its caller ends before it is done."""

from __future__ import annotations

from unittest.mock import Mock

import numpy as np
import pytest
from data_files import crop

from sgicodec import EncodeSettings, NullListener, Picture, decode, encode_picture
from sgicodec.rdoq import coordinate_descent


@pytest.fixture(scope="module")
def picture() -> Picture:
    return crop("kodim23", np.s_[100:164, 150:246])


@pytest.mark.parametrize("step", [3, None])
def test_no_pass_follows_an_end(picture: Picture, step: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Forty passes of RDOQ took a minute after Ctrl-C. It ends the fit at a step, or what comes after it."""
    monkeypatch.setattr(coordinate_descent, "descend", Mock(side_effect=AssertionError("a pass")))
    listener = Mock(wraps=NullListener(), ending=lambda: True, step=lambda at: step is None or at.step < step)
    encoded = encode_picture(picture, EncodeSettings(steps=40, tune="psnr"), progress=listener, verify=True)
    assert encoded.ended_early
    assert encoded.steps == (step or 40)
    assert encoded.psnr is not None
    assert encoded.psnr > 20
    assert np.abs(decode(encoded.data).astype(int) - picture.pixels).mean() < 20
