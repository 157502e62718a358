"""Tiles over a Dask cluster: the same bytes, and workers that may die."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("distributed")

from sgicodec import EncodeSettings, encode, read
from sgicodec.cli.main import cli
from sgicodec.errors import PictureError, TileFailedError, UsageError
from sgicodec.image import Picture, open_source, write
from sgicodec.large.cluster import open_cluster
from sgicodec.large.encode import plan_of
from sgicodec.large.task import Job, ReadingTask
from sgicodec.tile_work import FitTask, Start


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


@pytest.mark.parametrize("options", [(), ("--send-pixels",)])
def test_same_bytes_as_one_process(
    photo: Path, settings: EncodeSettings, tmp_path: Path, options: tuple[str, ...]
) -> None:
    from click.testing import CliRunner

    out = tmp_path / "out.sgi"
    arguments = ["encode", str(photo), str(out), "--tile", "64", "--steps", "8", "--cluster", "local:2", *options]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 0, result.output
    assert out.read_bytes() == encode(read(photo), settings).data


def test_goals_on_a_cluster(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    from click.testing import CliRunner

    out = tmp_path / "out.sgi"
    arguments = ["encode", str(photo), str(out), "--tile", "40", "--steps", "8", "--bpp", "0.9", "--cluster", "local:2"]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 0, result.output
    assert out.read_bytes() == encode(read(photo), replace(settings, tile=40, bpp=0.9)).data


@pytest.mark.parametrize("address", ["local:0", "local:x", "tcp://127.0.0.1:1"])
def test_addresses_without_a_cluster(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sgicodec.large.cluster._PATIENCE_SECONDS", 0.3)
    with pytest.raises(UsageError, match="cluster"), open_cluster(address):
        pass


def test_workers_read_paths_and_urls(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    with open_source(photo) as source:
        plan = plan_of(source, settings)
    job, work = Job(None, Start()), FitTask(plan)
    by_path, by_url = (ReadingTask(plan, place, work, 1)(4, job) for place in (str(photo), photo.as_uri()))
    assert by_path.payload == by_url.payload
    other = tmp_path / "other.png"
    write(Picture(np.zeros((9, 9, 3), np.uint8), "rgb", (0.0, 255.0)), other)
    with pytest.raises(PictureError, match="another picture"):
        ReadingTask(plan, str(other), work, 1)(0, job)
    with pytest.raises(PictureError):
        ReadingTask(plan, (tmp_path / "missing.png").as_uri(), work, 1)(0, job)
