"""Goals for all tiles of a file: the same bytes by whoever."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from sgicodec import EncodeSettings, encode_picture, open_source, read
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.progress import NullListener, PassState
from sgicodec.encoder.tiles.checkpoint import Checkpoint
from sgicodec.executors.processes import ProcessExecutor
from sgicodec.metrics.psnr import psnr

GOALS: tuple[dict[str, float], ...] = ({"bpp": 1.5}, {"psnr": 28.0})


@pytest.fixture(params=GOALS, ids=["bpp", "psnr"], scope="module")
def goal(request: pytest.FixtureRequest, settings: EncodeSettings) -> EncodeSettings:
    return replace(settings, tile=40, **request.param)


@pytest.fixture(scope="module")
def expected(photo: Path, goal: EncodeSettings) -> bytes:
    data = encode_picture(read(photo), goal).data
    if goal.bpp is not None:
        assert 0.97 * goal.bpp <= 8 * len(data) / (150 * 100) <= goal.bpp
    else:
        assert psnr(read(photo).pixels, open_stream(data).picture().pixels) == pytest.approx(goal.psnr, abs=0.1)
    return data


class Watch(NullListener):
    """Remembers the passes."""

    def __init__(self) -> None:
        self.passes = set[str]()

    def tile(self, state: PassState) -> None:
        self.passes.add(state.name)


def test_two_workers_give_the_same_bytes(photo: Path, goal: EncodeSettings, expected: bytes, tmp_path: Path) -> None:
    watch, out, store = Watch(), tmp_path / "out.sgi", Checkpoint(tmp_path / "out.part", resume=True)
    with open_source(photo) as source:
        encode_picture(source, goal, output=out, executor=ProcessExecutor(2), store=store, progress=watch)
    assert out.read_bytes() == expected
    assert watch.passes - {"overview"} == {"tiles"}  # in stated steps, no drafts come first
