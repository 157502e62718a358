"""Goals for all tiles of a file: the same bytes by whoever, interrupted in whatever round."""

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


class Stopping(NullListener):
    """Remembers the passes, and presses Ctrl-C after so many states."""

    def __init__(self, after: int = -1) -> None:
        self.left, self.passes = after, list[str]()

    def tile(self, state: PassState) -> None:
        if state.name not in self.passes[-1:]:
            self.passes.append(state.name)
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def encoded(photo: Path, settings: EncodeSettings, folder: Path, workers: int, watch: Stopping) -> bytes:
    out, checkpoint = folder / "out.sgi", Checkpoint(folder / "out.part", resume=True)
    with open_source(photo) as source:
        executor = ProcessExecutor(workers)
        encode_picture(source, settings, output=out, executor=executor, store=checkpoint, progress=watch)
    return out.read_bytes()


def test_two_workers_give_the_same_bytes(photo: Path, goal: EncodeSettings, expected: bytes, tmp_path: Path) -> None:
    watch = Stopping()
    assert encoded(photo, goal, tmp_path, 2, watch) == expected
    passes = [name for name in watch.passes if name != "overview"]
    assert set(passes) == {"tiles"}  # in stated steps, no drafts come first
