"""Jobs over threads: all results, as many at once as there are workers, second tries, and ends before the last."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from threading import Barrier, Event, Lock, get_ident
from typing import Any

import numpy as np
import pytest
from children import HANGS
from fake_cuda import only_gpu, shared_gpu

from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile import stages
from sgicodec.encoder.tile.state import Watch
from sgicodec.errors import PictureError, TileFailedError, UsageError
from sgicodec.executors.executor import MIB, Memory
from sgicodec.executors.serial import SerialExecutor
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


def test_a_second_try() -> None:
    tries, lock = Counter[int](), Lock()

    def fails(number: int, most: int) -> int:
        with lock:
            tries[number] += 1
        if number == 3 and tries[number] <= most:
            raise MemoryError("for a moment")
        return most

    assert dict(ThreadExecutor(2).run(fails, range(5), lambda _: 1)) == dict.fromkeys(range(5), 1)
    assert tries == {0: 1, 1: 1, 2: 1, 3: 2, 4: 1}
    tries.clear()
    with pytest.raises(TileFailedError, match="tile 3: for a moment") as caught:
        dict(ThreadExecutor(2).run(fails, range(5), lambda _: 9))
    assert isinstance(caught.value.__cause__, MemoryError)


def test_what_is_the_inputs_fails_once() -> None:
    tries = list[int]()

    def refuses(number: int, job: int) -> int:
        tries.append(number)
        raise PictureError("no such picture")

    with pytest.raises(TileFailedError, match="no such picture"):
        dict(ThreadExecutor(1).run(refuses, [4, 5], whole))
    assert tries == [4]


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


def test_workers_within_memory_and_threads_of_each() -> None:
    memory = Memory(100 * MIB, 50 * MIB, 20 * MIB)
    executor = ThreadExecutor(8, 250 * MIB).within(memory, 6)
    assert isinstance(executor, ThreadExecutor)
    assert executor.workers == 3
    assert executor.device(Device(7), 20) == Device(2)
    assert isinstance(ThreadExecutor(8, 130 * MIB).within(memory, 6), SerialExecutor)
    with pytest.raises(UsageError, match="--max-memory"):
        ThreadExecutor(8, 90 * MIB).within(memory, 6)
    assert ThreadExecutor().workers > 1
    for workers in (-1, 1.5):
        with pytest.raises(UsageError, match="workers"):
            ThreadExecutor(workers)  # type: ignore[arg-type]


SETTINGS = EncodeSettings(steps=4, tile=48, tune="psnr")


def pixels() -> Picture:
    y, x = np.mgrid[:50, :110]
    samples = np.stack([x, 2 * y, 255 - x], axis=2) + np.random.default_rng(1).integers(0, 9, (50, 110, 3))
    return Picture(np.clip(samples, 0, 255).astype(np.uint8), "rgb", (0, 255))


def test_one_tile_is_fitted_while_another_is_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first tile's search waits until the second tile's fit has run on the GPU; the bytes are those of one tile at
    a time.
    """
    device, fitted, lock = only_gpu(monkeypatch), Event(), Lock()
    expected = encode_picture(pixels(), SETTINGS, device=device).data
    searched, fit, fits = stages.rdoq, stages.fit, list[int]()

    def counted(*arguments: Any) -> Any:
        found = fit(*arguments)
        with lock:
            fits.append(get_ident())
        if len(set(fits)) > 1:
            fitted.set()
        return found

    def waits(*arguments: Any) -> Any:
        assert fitted.wait(HANGS)
        return searched(*arguments)

    monkeypatch.setattr(stages, "fit", counted)
    monkeypatch.setattr(stages, "rdoq", waits)
    data = encode_picture(pixels(), SETTINGS, device=device, executor=ThreadExecutor(2)).data
    assert data == expected
    with open_stream(data) as stream:
        assert stream.grid.count == len(fits) > 3


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


def test_the_command_line_uses_threads_for_one_gpu() -> None:
    from sgicodec.cli import encode_file

    given = []
    for device in (Device(2), Device(2, gpu=1), Device(2, gpu=0, gpus=3)):
        options = type("Options", (), {"device": device, "max_memory": None, "resume": False, "cluster": None})
        options.settings = EncodeSettings(tile=32)  # type: ignore[attr-defined]
        source = type("Source", (), {"width": 90, "height": 90})
        executor = encode_file._executor("in.png", options, source, None)  # type: ignore[arg-type]
        given.append((type(executor).__name__, executor.workers))  # type: ignore[union-attr]
    assert given == [("ProcessExecutor", 2), ("ThreadExecutor", 3), ("GpuExecutor", 3)]
