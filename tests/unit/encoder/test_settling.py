"""Seeds that are searched again beside texture: fewer bytes at the same error, and seeds for the eye stay."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, Picture, read
from sgicodec.encoder.candidate import Candidate
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import Tune
from sgicodec.encoder.settling import with_settled_seeds
from sgicodec.encoder.tile_encoder import Encoding
from sgicodec.metrics.distortion import squared_error

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"
STEPS = 350


@cache
def encoding(tune: Tune, quality: float = 54) -> tuple[Encoding, Candidate]:
    """Of 256×192 pixels of a parrot, and what its fit and search found."""
    photo = read(PHOTO)
    picture: Picture = replace(photo, pixels=np.ascontiguousarray(photo.pixels[100:292, 200:456]))
    settings = EncodeSettings(quality=quality, steps=STEPS, tune=tune, metadata=False)
    part = Encoding(picture, stream_plan(Shape.of(picture), settings), time.monotonic())
    return part, part.searched(part.candidate(part.fitted(None)))


def cost(part: Encoding, candidate: Candidate) -> tuple[int, float]:
    """Bytes and squared error of the stream of these seeds with texture."""
    data = part.encoded(part.textured(candidate)).data
    return len(data), squared_error(part.picture, part.stream.decoded(data))


def settled(monkeypatch: pytest.MonkeyPatch, part: Encoding, candidate: Candidate, rounds: int) -> Candidate:
    monkeypatch.setattr(part, "effort", replace(part.effort, rounds=rounds))
    return part.settled(candidate)


def test_the_same_error_takes_fewer_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the slope that two qualities have."""
    part, candidate = encoding("psnr")
    size, error = cost(part, candidate)
    less, more = cost(*encoding("psnr", 48))
    octaves = math.log(size / less) / math.log(more / error)
    for rounds in (1, 3):
        found, left = cost(part, settled(monkeypatch, part, candidate, rounds))
        assert math.log(found / size) < octaves * math.log(error / left) - 0.005


def test_seeds_for_the_eye_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    part, candidate = encoding("visual")
    assert settled(monkeypatch, part, candidate, 3) is candidate


def test_none_without_a_search_or_texture(monkeypatch: pytest.MonkeyPatch) -> None:
    part, candidate = encoding("psnr")
    for settings in ({"rdoq": False}, {"texture": False}):
        plan = stream_plan(Shape.of(part.picture), replace(part.settings, **settings))
        other = Encoding(part.picture, plan, time.monotonic())
        assert settled(monkeypatch, other, candidate, 3) is candidate


def test_an_encode_that_is_to_end_settles_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    part, candidate = encoding("psnr")
    monkeypatch.setattr(part, "ending", lambda: True)
    assert settled(monkeypatch, part, candidate, 3) is candidate


def test_steps_of_seeds_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only symbols move: as many seeds, where they were, under the same context model."""
    part, candidate = encoding("psnr")
    left = part.unit - part.unit.mean(axis=(1, 2), keepdims=True)
    found = with_settled_seeds(candidate, left, part.lmbda, part.device, part.reference).model
    assert found.layout is candidate.model.layout
    assert found.networks is candidate.model.networks
