"""Encodes as users ask for them, with a GPU whose kernels are compiled for the host (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_cuda import fake_gpu, only_gpu

import sgicodec
from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.device import ONE_THREAD
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.tile import least_squares, score_ascent
from sgicodec.encoder.tile.handover import Handover
from sgicodec.encoder.tile.score_ascent import ScoreAscent
from sgicodec.metrics.perceptual import ssimulacra2
from sgicodec.metrics.psnr import psnr

STAGES = {
    "scouting": (Handover, "offsets_ahead"),
    "handover": (Handover, "run"),
    "ascent": (ScoreAscent, "run"),
    "offsets": (score_ascent, "better_offsets"),
    "seeds again": (least_squares, "with_seeds_for"),
}
"""What a whole encode does besides steps of a fit and RDOQ, by its name, and where it is called."""


@contextmanager
def noted() -> Iterator[set[str]]:
    """Collects the names of the stages that are run."""
    seen = set[str]()

    def watched(name: str, does: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *given, **named: (seen.add(name), does(*given, **named))[1]

    with pytest.MonkeyPatch.context() as patch:
        for name, (place, member) in STAGES.items():
            patch.setattr(place, member, watched(name, getattr(place, member)))
        yield seen


EYE = {"scouting", "handover", "ascent", "offsets"}


@pytest.mark.parametrize(
    ("options", "side", "stages"),
    [
        pytest.param({}, 64, EYE, id="visual"),
        pytest.param({}, 96, EYE, id="visual, larger", marks=pytest.mark.slow),
        pytest.param({"tune": "psnr"}, 96, {"scouting", "handover", "seeds again"}, id="psnr", marks=pytest.mark.slow),
        pytest.param({"ssimulacra2": 70.0}, 96, EYE, id="ssimulacra2", marks=pytest.mark.slow),
        pytest.param({"tile": 48}, 96, EYE, id="tiles", marks=pytest.mark.slow),
    ],
)
def test_whole_encodes(
    options: dict[str, Any], side: int, stages: set[str], kodim23: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the default effort, through all that it does: the same bytes twice, and about as good as the processor's."""
    picture = Picture(np.ascontiguousarray(kodim23[176 : 176 + side, 96 : 96 + side]), "rgb", (0, 255))
    settings, device = EncodeSettings(**options), only_gpu(monkeypatch)
    with noted() as seen:
        ours = encode_picture(picture, settings, device=device)
    assert seen == stages
    again, theirs = (encode_picture(picture, settings, device=one) for one in (device, ONE_THREAD))
    assert ours.data == again.data != theirs.data
    assert ours.steps == theirs.steps == 600
    (score, ratio), (expected, other) = (measured(picture, encoded) for encoded in (ours, theirs))
    assert ours.size == pytest.approx(theirs.size, rel=0.1)
    assert ratio == pytest.approx(other, abs=1.0)
    assert score == pytest.approx(expected, abs=10.0)  # chance moves that of so few pixels so far
    if "ssimulacra2" in options:
        assert score == pytest.approx(options["ssimulacra2"], abs=1.5)


def test_the_paper_profile(kodim23: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    """Through every phase: the same bytes twice, and as good as the processor's."""
    picture = Picture(np.ascontiguousarray(kodim23[176:240, 96:176]), "rgb", (0, 255))
    asked = EncodeSettings(profile="paper", seeds=60, per_seed=3, features=9, levels=2, steps=150)
    device = only_gpu(monkeypatch)
    ours, again, theirs = (encode_picture(picture, asked, device=one) for one in (device, device, ONE_THREAD))
    assert ours.data == again.data != theirs.data
    assert ours.devices == {fake_gpu().name: 1}
    assert ours.size == pytest.approx(theirs.size, rel=0.05)
    assert measured(picture, ours)[1] == pytest.approx(measured(picture, theirs)[1], abs=0.5)


def measured(picture: Picture, encoded: Encoded) -> tuple[float, float]:
    """SSIMULACRA 2 and PSNR of what a stream decodes to."""
    decoded = sgicodec.decode(encoded.data)
    return ssimulacra2(picture.pixels, decoded), psnr(picture.pixels, decoded)


@pytest.fixture(scope="module")
def kodim23() -> np.ndarray:
    return sgicodec.read(Path(__file__).parents[1] / "data" / "kodim23.png").pixels
