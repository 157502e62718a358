"""The whole codec on real pictures: what quality buys, and what a short fit of the paper profile reaches."""

from __future__ import annotations

from unittest.mock import Mock

import numpy as np
import pytest
from data_files import crop
from image_files import by_pillow

from sgicodec import Encoded, EncodeSettings, NullListener, Picture, decode, encode_picture, read
from sgicodec.metrics.psnr import psnr


@pytest.fixture(scope="module", params=["kodim23", "kodim13"])
def coded(request: pytest.FixtureRequest) -> tuple[Picture, dict[int, Encoded]]:
    picture = crop(request.param, np.s_[128:320, 96:352])
    return picture, {q: encode_picture(picture, EncodeSettings(quality=q, steps=250)) for q in (30, 50, 70)}


def test_quality_raises_both_rate_and_fidelity(coded: tuple[Picture, dict[int, Encoded]]) -> None:
    picture, streams = coded
    sizes = [len(stream.data) for stream in streams.values()]
    scores = [psnr(picture.pixels, decode(stream.data)) for stream in streams.values()]
    assert sizes == sorted(sizes)
    assert scores == sorted(scores)
    assert scores[-1] - scores[0] > 3


def test_smaller_than_jpeg_at_the_same_fidelity(coded: tuple[Picture, dict[int, Encoded]]) -> None:
    """A peer measured in the same run: JPEG at the quality that reaches the same PSNR is larger."""
    picture, streams = coded
    ours = streams[30].data
    score = psnr(picture.pixels, decode(ours))
    for quality in range(1, 96):
        theirs = by_pillow(picture.pixels, "JPEG", quality=quality, optimize=True, progressive=True)
        if psnr(picture.pixels, read(theirs).pixels) >= score:
            break
    assert len(ours) < len(theirs)


def test_a_short_fit() -> None:
    """Of 2,400 Gaussians, one for 10 pixels. Where features cannot leave the noise, every seed shows one colour, at
    14 dB; what the stream holds is what the fit saw, under noise; and MLP_p is asked at full size, under noise, alone.
    """
    picture, listener = crop("kodim23", np.s_[160:288, 80:272]), Mock(wraps=NullListener())
    data = encode_picture(picture, EncodeSettings(profile="paper", steps=300, seeds=240), progress=listener).data
    decoded, steps = psnr(picture.pixels, decode(data)), [one.args[0] for one in listener.step.mock_calls]
    assert decoded > 23.0
    assert len(data) < 18_000
    assert abs(decoded - float(np.mean([step.psnr for step in steps[-10:]]))) < 0.3
    assert not any(step.bits for step in steps[:222])
    assert min(step.bits for step in steps[222:]) > 0
