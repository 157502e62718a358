"""Tiles over a Dask cluster: the same bytes, and workers that may die."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_cuda import contexts_in, fake_machine
from sanitizer import needs_plain_memory

pytest.importorskip("distributed")

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.cli.main import cli
from sgicodec.device import ONE_THREAD
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.plan import Plan, stream_plan
from sgicodec.encoder.tiles.runner import ReadingTask, TileJob
from sgicodec.encoder.tiles.tasks import FitTask
from sgicodec.errors import PictureError, TileFailedError, UsageError
from sgicodec.executors.dask import open_cluster
from sgicodec.image import open_source, write
from sgicodec.picture import Picture


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
    from click.testing import CliRunner

    out = tmp_path / "out.sgi"
    arguments = [
        "encode",
        str(photo),
        str(out),
        "--tile",
        "64",
        "--steps",
        "8",
        "--overview",
        "--cluster",
        "local:2",
        *options,
    ]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 0, result.output
    assert out.read_bytes() == encode_picture(read(photo), settings).data


def test_goals_on_a_cluster(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    from click.testing import CliRunner

    out = tmp_path / "out.sgi"
    arguments = ["encode", str(photo), str(out), "--tile", "40", "--steps", "8", "--bpp", "0.9"]
    result = CliRunner().invoke(cli, [*arguments, "--overview", "--cluster", "local:2"])
    assert result.exit_code == 0, result.output
    assert out.read_bytes() == encode_picture(read(photo), replace(settings, tile=40, bpp=0.9)).data


def encode_on_a_cluster(photo: Path, out: Path, *options: str) -> Any:
    from click.testing import CliRunner

    arguments = ["encode", str(photo), str(out), "--tile", "64", "--steps", "8", "--no-texture", *options]
    return CliRunner().invoke(cli, [*arguments, "--cluster", "local:2"])


@pytest.mark.parametrize("name", ["auto", pytest.param("cuda", marks=pytest.mark.slow)])
def test_workers_take_gpus_as_they_find_them(
    name: str, photo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """This process has none; the workers have two, and each takes another one."""
    needs_plain_memory()
    contexts = fake_machine(monkeypatch, tmp_path, 2)
    result = encode_on_a_cluster(photo, tmp_path / "out.sgi", "--device", name)
    assert result.exit_code == 0, result.output
    assert sorted(map(sorted, contexts_in(contexts).values())) == [[0], [1]]
    assert str(os.getpid()) not in contexts_in(contexts)
    monkeypatch.undo()
    cpu = encode_on_a_cluster(photo, tmp_path / "cpu.sgi", "--device", "auto")
    assert cpu.exit_code == 0, cpu.output
    assert (tmp_path / "out.sgi").read_bytes() != (tmp_path / "cpu.sgi").read_bytes()


def test_a_worker_without_a_gpu_is_named(photo: Path, tmp_path: Path) -> None:
    result = encode_on_a_cluster(photo, tmp_path / "out.sgi", "--device", "cuda")
    assert result.exit_code == TileFailedError.exit_code
    last = result.stderr.splitlines()[-1]
    assert re.fullmatch(
        r"sgi: tile \d+: worker tcp://127.0.0.1:\d+: no NVIDIA driver: libcuda.so.1 cannot be loaded", last
    )
    other = encode_on_a_cluster(photo, tmp_path / "out.sgi", "--device", "gpu")
    assert (other.exit_code, other.stderr) == (2, "sgi: device 'gpu'; it must be auto, cpu, cuda or cuda:N\n")


@pytest.mark.parametrize("address", ["local:0", "local:x", "tcp://127.0.0.1:1"])
def test_addresses_without_a_cluster(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sgicodec.executors.dask._PATIENCE_SECONDS", 0.3)
    with pytest.raises(UsageError, match="cluster"), open_cluster(address):
        pass


@pytest.mark.parametrize(("address", "place"), [(3, None), ("local:0", None), ("local:", None), ("tcp://a:1", 3)])
def test_what_is_no_address_or_place_is_refused_at_the_call(address: Any, place: Any) -> None:
    with pytest.raises(UsageError, match=r"cluster|place 3"):
        open_cluster(address, place)


def plan_of(photo: Path, settings: EncodeSettings) -> Plan:
    with open_source(photo) as source:
        return stream_plan(windows_of(source).shape, settings)


def test_workers_read_paths_and_urls(photo: Path, settings: EncodeSettings, tmp_path: Path) -> None:
    plan = plan_of(photo, settings)
    job, work = TileJob(None, b""), FitTask(plan)
    by_path, by_url = (ReadingTask(plan, place, work, ONE_THREAD)(4, job) for place in (str(photo), photo.as_uri()))
    assert by_path.payload == by_url.payload
    other = tmp_path / "other.png"
    write(Picture(np.zeros((9, 9, 3), np.uint8), "rgb", (0.0, 255.0)), other)
    with pytest.raises(PictureError, match="another picture"):
        ReadingTask(plan, str(other), work, ONE_THREAD)(0, job)
    with pytest.raises(PictureError):
        ReadingTask(plan, (tmp_path / "missing.png").as_uri(), work, ONE_THREAD)(0, job)


@pytest.mark.parametrize("address", [3, None, b"local:2"])
def test_what_is_no_address_is_told_at_the_call(address: object) -> None:
    with pytest.raises(UsageError, match="give the address of a scheduler"):
        open_cluster(address)  # type: ignore[arg-type]
