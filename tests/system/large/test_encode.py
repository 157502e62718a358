"""Encodes from a file: the same bytes with any workers, in any order, interrupted or not, with a goal or without."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from sgicodec import Checkpoint, EncodeSettings, ProcessExecutor, decode, encode_picture, open_source, read
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.tiles.store import Store
from sgicodec.errors import UsageError
from sgicodec.executors.executor import MIB, Executor, Memory
from sgicodec.metrics.psnr import psnr


@pytest.fixture(scope="module")
def expected(photo: Path, settings: EncodeSettings) -> bytes:
    """The stream that one call makes of the picture in memory."""
    return encode_picture(read(photo), settings).data


class Backwards(Executor):
    """Takes the tiles in the opposite order."""

    def run(self, task: Any, numbers: Iterable[int], job_of: Any) -> Iterator[tuple[int, Any]]:
        return super().run(task, sorted(numbers, reverse=True), job_of)


@pytest.mark.parametrize("executor", [Executor(), Backwards(), ProcessExecutor(2)], ids=type)
def test_same_bytes_for_any_executor(
    photo: Path, settings: EncodeSettings, expected: bytes, executor: Executor
) -> None:
    target = io.BytesIO()
    with open_source(photo) as source:
        found = encode_picture(source, settings, output=target, executor=executor)
    assert target.getvalue() == expected
    assert (found.size, found.data) == (len(expected), b"")


@pytest.mark.parametrize("tile", [0, 64])
def test_a_file_object_takes_a_stream_that_was_verified(photo: Path, settings: EncodeSettings, tile: int) -> None:
    target, one = io.BytesIO(), replace(settings, tile=tile)
    with open_source(photo) as source:
        written = encode_picture(source, one, output=target, verify=True)
        returned = encode_picture(source, one, verify=True)
    assert target.getvalue() == returned.data
    assert written.psnr == returned.psnr is not None


@pytest.mark.parametrize("output", [False, True])
def test_a_source_in_one_tile(photo: Path, settings: EncodeSettings, output: bool) -> None:
    """The same stream as of the picture in memory."""
    whole, target = replace(settings, tile=0), io.BytesIO()
    with open_source(photo) as source:
        found = encode_picture(source, whole, output=target if output else None)
    expected = encode_picture(read(photo), whole)
    assert replace(found, data=expected.data) == expected
    assert found.data == (b"" if output else expected.data)
    assert target.getvalue() == (expected.data if output else b"")


def test_going_on_gives_the_same_bytes(photo: Path, settings: EncodeSettings, expected: bytes) -> None:
    """After Ctrl-C behind the third tile, whose pass the overview's comes before."""
    store, target, states = Store(), io.BytesIO(), list[tuple[int, int]]()
    stopped = Mock(wraps=NullListener(), tile=Mock(side_effect=[*[None] * 4, KeyboardInterrupt]))
    watch = Mock(wraps=NullListener(), tile=lambda state: states.append((state.done, state.fresh)))
    with open_source(photo) as source:
        with pytest.raises(KeyboardInterrupt):
            encode_picture(source, settings, output=target, store=store, progress=stopped)
        assert sorted(store.tiles) == [(0, 0), (1, 0), (2, 0)]
        assert not target.getvalue()
        encode_picture(source, settings, output=target, store=store, progress=watch)
    assert target.getvalue() == expected
    assert [done for done, _ in states] == [3, 4, 5, 6]
    assert (states[0][1], states[-1][1]) == (0, 150 * 50)


def test_workers_that_fit() -> None:
    found = Memory(main=100 * MIB, worker=400 * MIB)
    assert ProcessExecutor(8, 1000 * MIB).within(found, 5).workers == 2
    assert ProcessExecutor(8).within(found, 5).workers == 5
    assert type(ProcessExecutor(8).within(found, 1)) is Executor
    with pytest.raises(UsageError, match="about 500 MiB"):
        ProcessExecutor(8, 499 * MIB).within(found, 5)


def test_two_workers_give_the_same_bytes_towards_a_goal(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    """Tiles are read from the checkpoint again, to be decoded."""
    goal, watch = replace(settings, tile=40, psnr=28.0), Mock(wraps=NullListener())
    expected = encode_picture(read(photo), goal).data
    assert psnr(read(photo).pixels, decode(expected)) == pytest.approx(28, abs=0.1)
    out, store = tmp_path / "out.sgi", Checkpoint(tmp_path / "out.part", resume=True)
    with open_source(photo) as source:
        encode_picture(source, goal, output=out, executor=ProcessExecutor(2), store=store, progress=watch)
    assert out.read_bytes() == expected
    passes = {call.args[0].name for call in watch.tile.mock_calls}
    assert passes - {"overview"} == {"tiles"}  # in stated steps, no drafts come first
