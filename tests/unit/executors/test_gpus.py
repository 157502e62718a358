"""Jobs over several GPUs: a process for each, which sees no other, and threads within."""

from __future__ import annotations

import os
import threading
from collections import defaultdict
from functools import partial
from pathlib import Path

import pytest
from children import HANGS

from sgicodec.device import Device
from sgicodec.errors import NoDeviceError, TileFailedError
from sgicodec.executors.gpus import GpuExecutor

barrier = threading.Barrier(2)


def meets(number: int, job: int) -> tuple[int, str, int]:
    """Ends when another job does the same in this process."""
    barrier.wait(HANGS)
    return os.getpid(), os.environ["CUDA_VISIBLE_DEVICES"], job


def test_a_process_for_each_gpu_and_threads_within() -> None:
    """Two jobs of a process are under way at the same time."""
    found = dict(GpuExecutor(2, 4, first=1).run(meets, range(4), lambda number: 10 * number))
    assert {number: job for number, (_, _, job) in found.items()} == {number: 10 * number for number in range(4)}
    seen = defaultdict(list)
    for process, gpu, _ in found.values():
        seen[process].append(gpu)
    assert sorted(seen.values()) == [["1", "1"], ["2", "2"]]


def sees(number: int, job: int) -> str:
    return os.environ["CUDA_VISIBLE_DEVICES"]


def test_gpus_that_are_visible_keep_their_names(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "3,GPU-8932, 0")
    assert set(dict(GpuExecutor(2, 2, first=1).run(sees, range(2), int)).values()) == {"GPU-8932", "0"}
    with pytest.raises(NoDeviceError, match="no GPU 3: CUDA_VISIBLE_DEVICES names 3"):
        list(GpuExecutor(2, 2, first=2).run(sees, range(2), int))


def dies_once(folder: Path, number: int, job: int) -> str:
    """Takes its process down at tile 1, the first time, with what else it does."""
    mark = folder / "died"
    if number == 1 and not mark.exists():
        mark.touch()
        os._exit(9)
    return sees(number, job)


def always_dies(number: int, job: int) -> int:
    os._exit(7)


def test_a_process_that_dies_is_replaced_at_its_gpu(tmp_path: Path) -> None:
    found = dict(GpuExecutor(1, 2, first=5).run(partial(dies_once, tmp_path), range(6), int))
    assert found == dict.fromkeys(range(6), "5")
    assert (tmp_path / "died").exists()
    with pytest.raises(TileFailedError, match=r"tile \d: its process ended with status 7"):
        list(GpuExecutor(2, 4).run(always_dies, range(6), int))


def test_a_process_has_one_gpu_and_its_share_of_the_threads() -> None:
    assert GpuExecutor(2, 4).device(Device(8, "portable", gpu=1, gpus=2), 9) == Device(2, "portable", gpu=0)
    assert GpuExecutor(2, 4).device(Device(8), 2) == Device(4)
