"""Jobs over threads: all results, as many at once as there are workers, second tries, and ends before the last."""

from __future__ import annotations

from dataclasses import replace
from threading import Barrier, Event
from typing import Any

import numpy as np
import pytest
from children import HANGS
from fake_cuda import only_gpu, shared_gpu

from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.state import Watch
from sgicodec.executors.threads import ThreadExecutor, stopping
from sgicodec.picture import Picture


def whole(number: int) -> int:
    return number


def test_all_results_of_several_at_once() -> None:
    """Three jobs wait for each other; no fourth is asked for before one has ended."""
    barrier, asked, done = Barrier(3), list[int](), list[int]()

    def job_of(number: int) -> int:
        asked.append(number)
        assert len(asked) - len(done) <= 3
        return number + 10

    def meet(number: int, job: int) -> int:
        barrier.wait(HANGS)
        return job * job

    for number, result in ThreadExecutor(3).run(meet, range(6), job_of):
        done.append(number)
        assert result == (number + 10) ** 2
    assert asked == sorted(done) == list(range(6))


def test_who_ends_early_waits_for_jobs_that_stop() -> None:
    begun, ended = Barrier(3), list[int]()
    first = Event()

    def goes_on(number: int, job: int) -> int:
        assert not stopping()
        begun.wait(HANGS)
        if number == 0:
            return first.set() or 0
        while not stopping():
            first.wait(0.001)
        ended.append(number)
        return 0

    run = ThreadExecutor(3).run(goes_on, range(9), whole)
    assert next(run) == (0, 0)
    run.close()
    assert sorted(ended)[:2] == [1, 2]
    assert not stopping()
    assert len(ended) <= 3


SETTINGS = EncodeSettings(steps=4, tile=48, tune="psnr")


def pixels() -> Picture:
    y, x = np.mgrid[:50, :110]
    samples = np.stack([x, 2 * y, 255 - x], axis=2) + np.random.default_rng(1).integers(0, 9, (50, 110, 3))
    return Picture(np.clip(samples, 0, 255).astype(np.uint8), "rgb", (0, 255))


def test_an_interrupt_ends_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of tiles under way, long before their last step."""
    device, begun = only_gpu(monkeypatch), list[int]()
    step = Watch.step

    def noted(self: Watch, progress: Any) -> bool:
        begun.append(progress.step)
        return step(self, progress)

    class Impatient(NullListener):
        def tile(self, state: Any) -> None:
            if state.done:
                raise KeyboardInterrupt

    monkeypatch.setattr(Watch, "step", noted)
    settings = replace(SETTINGS, steps=30)
    with pytest.raises(KeyboardInterrupt):
        encode_picture(pixels(), settings, device=device, executor=ThreadExecutor(2), progress=Impatient())
    assert 30 <= len(begun) < 30 * 8
    assert not shared_gpu().turn.locked()
