"""`--time-limit` of pictures in several tiles and in one."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result

from sgicodec.encoder.tile.state import Tile
from sgicodec.encoder.tiles import tasks

Run = Callable[..., Result]
OPTIONS = ("--tile", 32, "--steps", 4, "-j", 1)


def test_a_time_limit_over_tiles(sgi: Run, picture: Path, tmp_path: Path) -> None:
    out = tmp_path / "a.sgi"
    result = sgi("encode", picture, out, "--tile", 32, "-j", 1, "--time-limit", 3, "--json")
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    assert (report["tiles"], report["time_limit"]) == (2, 3.0)
    assert report["steps"] > 3
    assert sgi("verify", out).exit_code == 0


@pytest.mark.parametrize("tile", [0, 32])
def test_a_time_limit_that_cannot_be_kept_is_told(sgi: Run, picture: Path, tmp_path: Path, tile: int) -> None:
    out = tmp_path / "a.sgi"
    result = sgi("encode", picture, out, "--tile", tile, "-j", 1, "--time-limit", 0.001)
    assert result.exit_code == 0, result.output
    assert "s beyond the time limit)" in result.stdout
    assert sgi("verify", out).exit_code == 0
    assert "beyond" not in sgi("encode", picture, "-f", out, "--tile", tile, "-j", 1, "--steps", 2).stdout


def test_a_time_limit_with_a_goal_is_for_one_tile(sgi: Run, picture: Path) -> None:
    refused = sgi("encode", picture, "--tile", 32, "--time-limit", 3, "--size", 900)
    assert refused.exit_code == 2
    assert refused.stderr == (
        "sgi: a time limit goes with a size, a rate or a PSNR in a single tile only; --tile 0 makes one\n"
    )
    assert not picture.with_suffix(".sgi.part").exists()


def test_a_time_limit_goes_on_under_another(
    sgi: Run, picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fit, fitted = tasks.encode, list[int]()

    def interrupted(tile: Tile) -> object:
        if tile.number == 1:
            raise KeyboardInterrupt
        return fit(tile)

    def counted(tile: Tile) -> object:
        fitted.append(tile.number)
        return fit(tile)

    out, options = tmp_path / "a.sgi", ("--tile", 32, "-j", 1)
    monkeypatch.setattr(tasks, "encode", interrupted)
    assert sgi("encode", picture, out, *options, "--time-limit", 0.5).exit_code == 130
    monkeypatch.setattr(tasks, "encode", counted)
    assert sgi("encode", picture, out, *options, "-e", 1, "--resume").exit_code == 2
    resumed = sgi("encode", picture, out, *options, "--time-limit", 2, "--resume")
    assert resumed.exit_code == 0, resumed.output
    assert fitted == [1]
