"""Encodes from a file: the same bytes by whoever, in whatever order, interrupted or not."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from clock import Clock

from sgicodec import EncodeSettings, Picture, encode, open_stream, read
from sgicodec.encoder.checkpoint import Journal
from sgicodec.encoder.interfaces import Task
from sgicodec.encoder.measure import measured_psnr
from sgicodec.encoder.memory import MIB, Estimate, estimate, fitting_workers
from sgicodec.encoder.out_of_core import State, Totals, encode_source, plan_of, run_tiles
from sgicodec.encoder.tile_work import EncodedTile, Start
from sgicodec.errors import UsageError
from sgicodec.image import open_source
from sgicodec.metrics.psnr import psnr


@pytest.fixture(scope="module")
def expected(photo: Path, settings: EncodeSettings) -> bytes:
    """The stream that one call makes of the picture in memory."""
    return encode(read(photo), settings).data


def encoded(photo: Path, settings: EncodeSettings, workers: int, backwards: bool = False) -> tuple[bytes, Totals]:
    target = io.BytesIO()
    with open_source(photo) as source:
        plan = plan_of(source, settings)
        runner = run_tiles(source, plan, workers, workers)
        if backwards:
            forwards = runner

            def runner(
                task: Task[Any], numbers: Sequence[int], start: Callable[[int], Start], window: Picture | None = None
            ) -> Iterator[tuple[int, Any]]:
                return forwards(task, sorted(numbers, reverse=True), start, window)

        totals = encode_source(source, plan, runner, Journal(io.BytesIO(), bytes(32)), target)
    return target.getvalue(), totals


@pytest.fixture(autouse=True)
def _no_sync(monkeypatch: pytest.MonkeyPatch) -> None:
    """Journals in memory have nothing to sync."""
    monkeypatch.setattr(Journal, "_write", lambda self, data: self._file.write(data))


def test_same_bytes_for_any_workers_and_order(photo: Path, settings: EncodeSettings, expected: bytes) -> None:
    one, totals = encoded(photo, settings, 1)
    assert one == expected
    assert totals.bytes == len(expected)
    assert encoded(photo, settings, 1, backwards=True)[0] == expected
    assert encoded(photo, settings, 2)[0] == expected


def test_going_on_gives_the_same_bytes(photo: Path, settings: EncodeSettings, expected: bytes) -> None:
    states: list[tuple[int, int]] = []
    with open_source(photo) as source:
        plan = plan_of(source, settings)
        runner, journal, target = run_tiles(source, plan, 1, 1), Journal(io.BytesIO(), bytes(32)), io.BytesIO()

        def stop(state: State) -> None:
            if state.done == 3:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            encode_source(source, plan, runner, journal, target, stop)
        assert sorted(journal.tiles) == [(0, 0), (1, 0), (2, 0)]
        assert not target.getvalue()
        encode_source(source, plan, runner, journal, target, lambda state: states.append((state.done, state.fresh)))
    assert target.getvalue() == expected
    assert [done for done, _ in states] == [3, 4, 5, 6]
    assert states[0][1] == 0
    assert states[-1][1] == 150 * 50


def test_state_adds_up(clock: Clock) -> None:
    state = State(tiles=4, all_pixels=4000, started=clock.now)
    assert state.seconds_left == float("inf")
    state.add(EncodedTile(b"", {}, 1, 0.03, 300, 1.0, 125, 0.01), 1000, fresh=True)
    state.add(EncodedTile(b"", {}, 1, 0.03, 300, 1.0, 125, 0.01), 1000, fresh=False)
    assert (state.done, state.bpp) == (2, 1.0)
    assert state.psnr == pytest.approx(40.0)
    clock.now += 4.0
    assert state.pixels_per_second == 1000 / 4.0
    assert state.seconds_left == 2000 / 250.0


def test_measured_psnr_is_that_of_the_pictures(photo: Path, expected: bytes) -> None:
    with open_stream(expected) as stream, open_source(photo) as source:
        found = measured_psnr(stream, source)
        assert found == pytest.approx(psnr(read(photo).pixels, stream.picture().pixels), abs=1e-6)


def test_workers_that_fit() -> None:
    found = Estimate(main=100 * MIB, worker=400 * MIB)
    assert fitting_workers(found, 8, None) == 8
    assert fitting_workers(found, 8, 1000 * MIB) == 2
    with pytest.raises(UsageError, match="about 500 MiB"):
        fitting_workers(found, 8, 499 * MIB)


def test_the_estimate_depends_on_the_tile_not_on_the_picture(photo: Path, settings: EncodeSettings) -> None:
    with open_source(photo) as source:
        plan = plan_of(source, settings)
    wide = replace(plan, header=replace(plan.header, width=75 * 1000, height=50 * 1000, tile=75))
    near = replace(plan, header=replace(plan.header, width=75 * 10, height=75 * 10, tile=75))
    assert estimate(wide, 0).total(2) == pytest.approx(estimate(near, 0).total(2), rel=0.01)
    larger = replace(plan, header=replace(plan.header, width=7500, height=7500, tile=750))
    assert estimate(larger, 0).worker > estimate(near, 0).worker + 50 * MIB
