"""Tiles over a Dask cluster: the same bytes, and workers that may die."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command import done

pytest.importorskip("distributed")

from sgicodec import EncodeSettings, Picture, encode_picture, open_cluster, open_source, read, write
from sgicodec.device import ONE_THREAD
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.plan import stream_plan
from sgicodec.encoder.tiles.runner import PictureAt, TileTask
from sgicodec.encoder.tiles.tasks import FitTask
from sgicodec.errors import PictureError, TileFailedError, UsageError


def dies_once(folder: Path, number: int, job: int) -> int:
    mark = folder / "died"
    if number == 1 and not mark.exists():
        mark.touch()
        os._exit(9)
    return 10 * job


def refuses(number: int, job: int) -> int:
    raise PictureError("no such picture")


def test_a_worker_that_dies_is_survived(tmp_path: Path) -> None:
    with open_cluster("local:2") as cluster:
        assert cluster.workers == 2
        assert dict(cluster.run(partial(dies_once, tmp_path), range(5), lambda n: n)) == {n: 10 * n for n in range(5)}
        assert (tmp_path / "died").exists()
        with pytest.raises(TileFailedError, match="tile 3: no such picture"):
            dict(cluster.run(refuses, [3], lambda number: number))


@pytest.mark.parametrize("options", [pytest.param((), marks=pytest.mark.slow), ("--send-pixels",)])
def test_same_bytes_as_one_process(
    photo: Path, settings: EncodeSettings, tmp_path: Path, options: tuple[str, ...]
) -> None:
    out = tmp_path / "out.sgi"
    done("encode", photo, out, "--tile", 64, "--steps", 8, "--overview", "--cluster", "local:2", *options)
    assert out.read_bytes() == encode_picture(read(photo), settings).data


@pytest.mark.parametrize("address", ["local:0", "local:x", "tcp://127.0.0.1:1"])
def test_addresses_without_a_cluster(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sgicodec.executors.dask._PATIENCE_SECONDS", 0.3)
    with pytest.raises(UsageError, match="cluster"), open_cluster(address):
        pass


def test_workers_read_paths_and_urls(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    with open_source(photo) as source:
        plan = stream_plan(windows_of(source).shape, settings)
    fit = TileTask(FitTask(plan), ONE_THREAD)
    by_path, by_url = (fit(4, PictureAt(plan, place)) for place in (str(photo), photo.as_uri()))
    assert by_path.payload == by_url.payload
    other = tmp_path / "other.png"
    write(Picture(np.zeros((9, 9, 3), np.uint8), "rgb", (0.0, 255.0)), other)
    with pytest.raises(PictureError, match="another picture"):
        PictureAt(plan, str(other)).window(0)
    with pytest.raises(PictureError):
        PictureAt(plan, (tmp_path / "missing.png").as_uri()).window(0)
