"""Jobs over processes: all results, second tries, and failures that name their tile."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
from children import HANGS

from sgicodec import _native
from sgicodec.device import Device
from sgicodec.errors import PictureError, TileFailedError
from sgicodec.executors.executor import Executor
from sgicodec.executors.processes import ProcessExecutor


def square(number: int, job: int) -> int:
    return job * job


def is_deaf(number: int, job: int) -> bool:
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def dies_once(folder: Path, number: int, job: int) -> int:
    """Takes its process down at tile 2, the first time."""
    mark = folder / "died"
    if number == 2 and not mark.exists():
        mark.touch()
        os._exit(9)
    return job


def always_dies(number: int, job: int) -> int:
    if number == 1:
        os._exit(7)
    return job


def fails_once(folder: Path, number: int, job: int) -> int:
    mark = folder / "failed"
    if number == 3 and not mark.exists():
        mark.touch()
        raise MemoryError("for a moment")
    return job


def refuses(folder: Path, number: int, job: int) -> int:
    with (folder / "tries").open("a") as file:
        file.write("x")
    raise PictureError("no such picture")


def test_all_results_come_in_some_order() -> None:
    found = dict(ProcessExecutor(2).run(square, range(7), lambda number: number + 10))
    assert found == {number: (number + 10) ** 2 for number in range(7)}
    assert dict(Executor().run(square, range(3), lambda number: number)) == {0: 0, 1: 1, 2: 4}


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="threads have no masks of signals here")
def test_processes_never_hear_an_interrupt() -> None:
    assert dict(ProcessExecutor(2).run(is_deaf, range(2), lambda number: number)) == {0: True, 1: True}
    assert not is_deaf(0, 0)


def test_a_process_that_dies_is_survived(tmp_path: Path) -> None:
    task = partial(dies_once, tmp_path)
    assert dict(ProcessExecutor(2).run(task, range(5), lambda number: -number)) == {n: -n for n in range(5)}
    assert (tmp_path / "died").exists()


BUSY = """
import threading
from sgicodec.executors.processes import ProcessExecutor
def busy(number, job):
    print("busy", flush=True)
    threading.Event().wait()
if __name__ == "__main__":
    list(ProcessExecutor(1).run(busy, [0], lambda number: number))
"""


def test_workers_end_with_the_process_that_started_them(tmp_path: Path) -> None:
    """However long their tiles take: the pipe ends when nobody holds it any more."""
    (tmp_path / "main.py").write_text(BUSY)
    with subprocess.Popen([sys.executable, tmp_path / "main.py"], stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"busy\n"
        process.kill()
        assert process.communicate(timeout=HANGS)[0] == b""


def test_a_tile_that_fails_twice_is_named() -> None:
    with pytest.raises(TileFailedError, match="tile 1: its process ended with status 7") as caught:
        list(ProcessExecutor(2).run(always_dies, range(3), lambda number: number))
    assert caught.value.tile == 1


@pytest.mark.parametrize("executor", [Executor(), ProcessExecutor(2)], ids=["serial", "processes"])
def test_an_error_gets_a_second_try(tmp_path: Path, executor: Executor) -> None:
    task = partial(fails_once, tmp_path)
    assert dict(executor.run(task, range(4), lambda number: number)) == {n: n for n in range(4)}
    assert (tmp_path / "failed").exists()


def test_the_input_is_to_blame_at_once(tmp_path: Path) -> None:
    with pytest.raises(TileFailedError, match="tile 0: no such picture"):
        list(Executor().run(partial(refuses, tmp_path), range(2), lambda number: number))
    assert (tmp_path / "tries").read_text() == "x"


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="only Linux binds processes to cores")
def test_cores_are_those_that_the_process_is_bound_to() -> None:
    own = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(own)})
    try:
        assert (Device().cores, ProcessExecutor().workers, _native.resolve_threads(0)) == (1, 1, 1)
    finally:
        os.sched_setaffinity(0, own)
