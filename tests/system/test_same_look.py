"""The same look for a quality, as SSIMULACRA 2 judges finished streams of unlike pictures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.visual_score import visual_score

DATA = Path(__file__).parents[1] / "data"


def crop(name: str, left: int, top: int) -> Picture:
    whole = read(DATA / name)
    return replace(whole, pixels=np.ascontiguousarray(whole.pixels[top : top + 192, left : left + 256]))


def score(picture: Picture, settings: EncodeSettings) -> float:
    with open_stream(encode_picture(picture, settings).data) as stream:
        return visual_score(picture.pixels, stream.picture().pixels)


@pytest.mark.parametrize(("quality", "usual"), [(45.0, 53.0), (65.0, 76.0)])
def test_rocks_feathers_and_sky_look_alike(quality: float, usual: float) -> None:
    pictures = crop("kodim13.png", 100, 20), crop("kodim13.png", 300, 300), crop("kodim23.png", 250, 120)
    scores = [score(picture, EncodeSettings(quality=quality, effort=3)) for picture in pictures]
    assert scores == pytest.approx([usual] * 3, abs=4)


def test_λ_is_taken_as_it_is() -> None:
    settings = EncodeSettings(quality=45.0, effort=1)
    scores = [score(crop("kodim13.png", 100, 20), replace(settings, lmbda=lmbda)) for lmbda in (0.003, 0.012)]
    assert scores[0] > scores[1] + 10
