"""The whole codec on real pictures: what quality buys, and what a short fit of the paper profile reaches."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop
from image_files import by_pillow

from sgicodec import Encoded, EncodeSettings, NullListener, Picture, decode, encode_picture, read
from sgicodec.fit.trainer import Progress
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


class Watch(NullListener):
    """Keeps every step's PSNR, under the noise of that step, and bits."""

    def __init__(self) -> None:
        self.psnr: list[float] = []
        self.bits: list[float] = []

    def step(self, progress: Progress) -> bool:
        self.psnr.append(progress.psnr)
        self.bits.append(progress.bits)
        return True


def fitted(**settings: object) -> tuple[float, int, Watch]:
    """PSNR of what is decoded, bytes, and the steps of a fit of 2,400 Gaussians, one for 10 pixels."""
    picture, watch = crop("kodim23", np.s_[160:288, 80:272]), Watch()
    asked = EncodeSettings(profile="paper", steps=300, seeds=240, **settings)  # type: ignore[arg-type]
    data = encode_picture(picture, asked, progress=watch).data
    return psnr(picture.pixels, decode(data)), len(data), watch


def test_a_short_fit() -> None:
    """Where features cannot leave the noise, every seed shows one colour, at 14 dB; what the stream holds is what the
    fit saw; and MLP_p is asked at full size, under noise, alone.
    """
    decoded, size, watch = fitted()
    assert decoded > 23.0
    assert size < 18_000
    assert abs(decoded - float(np.mean(watch.psnr[-10:]))) < 0.3
    assert not any(watch.bits[:222])
    assert min(watch.bits[222:]) > 0
