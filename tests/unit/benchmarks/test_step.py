"""The parts of a step make up the whole, and nothing stays patched."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.step import PARTS, spent, stages
from sgicodec import EncodeSettings, encode, read

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_parts_make_up_the_whole() -> None:
    photo = read(PHOTO)
    crop = replace(photo, pixels=np.ascontiguousarray(photo.pixels[:96, :128]))
    plain = {(owner, name): getattr(owner, name) for methods in PARTS.values() for owner, name in methods}
    started = time.perf_counter()
    found = spent(crop, EncodeSettings(steps=40, threads=1))
    assert found.steps == 40
    assert list(found.seconds) == list(PARTS)
    assert min(found.seconds.values()) > 0
    assert sum(found.seconds.values()) < time.perf_counter() - started
    assert all(getattr(owner, name) is method for (owner, name), method in plain.items())


def test_stages_make_up_an_encode() -> None:
    photo = read(PHOTO)
    crop = replace(photo, pixels=np.ascontiguousarray(photo.pixels[:96, :128]))
    seconds, seeds = stages(crop, EncodeSettings(steps=40, threads=1))
    assert list(seconds) == ["base layer", "fit", "search", "stream"]
    assert min(seconds.values()) > 0
    assert seeds == encode(crop, EncodeSettings(steps=40, threads=1)).seeds
