"""Jobs over processes: all results, second tries, and failures that name their tile."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

import pytest

from sgicodec.errors import PictureError, TileFailedError
from sgicodec.executors.executor import Executor
from sgicodec.executors.processes import ProcessExecutor
from sgicodec.executors.serial import SerialExecutor


def square(number: int, job: int) -> int:
    return job * job


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
    assert dict(SerialExecutor().run(square, range(3), lambda number: number)) == {0: 0, 1: 1, 2: 4}


def test_a_process_that_dies_is_survived(tmp_path: Path) -> None:
    task = partial(dies_once, tmp_path)
    assert dict(ProcessExecutor(2).run(task, range(5), lambda number: -number)) == {n: -n for n in range(5)}
    assert (tmp_path / "died").exists()


def test_a_tile_that_fails_twice_is_named() -> None:
    with pytest.raises(TileFailedError, match="tile 1: its process ended with status 7") as caught:
        list(ProcessExecutor(2).run(always_dies, range(3), lambda number: number))
    assert caught.value.tile == 1


@pytest.mark.parametrize("executor", [SerialExecutor(), ProcessExecutor(2)], ids=["serial", "processes"])
def test_an_error_gets_a_second_try(tmp_path: Path, executor: Executor) -> None:
    task = partial(fails_once, tmp_path)
    assert dict(executor.run(task, range(4), lambda number: number)) == {n: n for n in range(4)}
    assert (tmp_path / "failed").exists()


def test_the_input_is_to_blame_at_once(tmp_path: Path) -> None:
    with pytest.raises(TileFailedError, match="tile 0: no such picture"):
        list(SerialExecutor().run(partial(refuses, tmp_path), range(2), lambda number: number))
    assert (tmp_path / "tries").read_text() == "x"


class Marking:
    """Leaves a mark when a process has it and can begin."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __setstate__(self, state: dict[str, Path]) -> None:
        self.folder = state["folder"]
        (self.folder / f"ready {os.getpid()}").touch()

    def __call__(self, number: int, job: int) -> int:
        return os.getpid()


def test_jobs_are_made_when_a_process_can_begin(tmp_path: Path) -> None:
    """As many marks lie there as tiles were handed out at first."""
    ready: list[int] = []

    def job_of(number: int) -> int:
        ready.append(len(list(tmp_path.iterdir())))
        return number

    found = dict(ProcessExecutor(2).run(Marking(tmp_path), range(6), job_of))
    assert len(found) == 6
    assert {f"ready {process}" for process in found.values()} <= {path.name for path in tmp_path.iterdir()}
    assert ready[0] >= 1
    assert ready == sorted(ready)


class CannotBegin:
    def __setstate__(self, state: object) -> None:
        os._exit(5)

    def __getstate__(self) -> str:
        return "a state"

    def __call__(self, number: int, job: int) -> int:
        return number


def test_a_process_that_cannot_begin_fails_its_tile() -> None:
    with pytest.raises(TileFailedError, match=r"tile \d: its process ended with status 5"):
        list(ProcessExecutor(2).run(CannotBegin(), range(3), lambda number: number))


def test_what_the_reader_raises_comes_through() -> None:
    def unreadable(number: int) -> int:
        raise PictureError("the file ends")

    with pytest.raises(PictureError, match="the file ends"):
        list(ProcessExecutor(1).run(square, range(2), unreadable))
