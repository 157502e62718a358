"""The whole codec on two real pictures, through the API that the command line uses."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import crop

from sgicodec import Encoded, EncodeSettings, Picture, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.psnr import psnr


@pytest.fixture(scope="module", params=["kodim23", "kodim13"])
def coded(request: pytest.FixtureRequest) -> tuple[Picture, dict[int, Encoded]]:
    picture = crop(request.param, np.s_[128:320, 96:352])
    return picture, {q: encode_picture(picture, EncodeSettings(quality=q, steps=250)) for q in (30, 50, 70)}


def test_quality_raises_both_rate_and_fidelity(coded: tuple[Picture, dict[int, Encoded]]) -> None:
    picture, streams = coded
    sizes = [len(stream.data) for stream in streams.values()]
    scores = [psnr(picture.pixels, open_stream(stream.data).picture().pixels) for stream in streams.values()]
    assert sizes == sorted(sizes)
    assert scores == sorted(scores)
    assert scores[-1] - scores[0] > 3


def test_smaller_than_jpeg_at_the_same_fidelity(coded: tuple[Picture, dict[int, Encoded]]) -> None:
    """A peer measured in the same run: JPEG at the quality that reaches the same PSNR is larger."""
    image = pytest.importorskip("PIL.Image")
    import io

    picture, streams = coded
    ours = streams[30]
    score = psnr(picture.pixels, open_stream(ours.data).picture().pixels)
    for quality in range(1, 96):
        buffer = io.BytesIO()
        image.fromarray(picture.pixels).save(buffer, "JPEG", quality=quality, optimize=True, progressive=True)
        if psnr(picture.pixels, np.asarray(image.open(buffer))) >= score:
            break
    assert len(ours.data) < buffer.tell()
