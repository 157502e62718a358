"""Stages without weights, on a real crop in a few steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.distortion import STAGES, encoded_without, main
from sgicodec import EncodeSettings, encode_picture, read, write
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.picture import Picture

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"
SETTINGS = EncodeSettings(lmbda=0.003, steps=30, distortion="weighted", texture=False)
DEVICE = Device(1)


@pytest.fixture(scope="module")
def crop() -> Picture:
    photo = read(PHOTO)
    return replace(photo, pixels=np.ascontiguousarray(photo.pixels[:96, :128]))


def test_with_all_stages_it_is_what_encode_gives(crop: Picture) -> None:
    assert encoded_without(crop, SETTINGS, (), DEVICE).data == encode_picture(crop, SETTINGS).data


def test_without_any_it_is_squared_error(crop: Picture) -> None:
    plain = encode_picture(crop, replace(SETTINGS, distortion="squared")).data
    found, expected = (
        open_stream(data).render() for data in (encoded_without(crop, SETTINGS, STAGES, DEVICE).data, plain)
    )
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_is_left_out(crop: Picture, stage: str) -> None:
    whole = encode_picture(crop, SETTINGS).data
    assert encoded_without(crop, SETTINGS, (stage,), DEVICE).data != whole


def test_a_row_for_each_stream(crop: Picture, tmp_path: Path) -> None:
    path = tmp_path / "crop.png"
    write(crop, path)
    arguments = [str(path), "--quality", "40", "--quality", "60", "--effort", "1", "--no-stages", "--threads", "1"]
    lines = CliRunner().invoke(main, arguments, catch_exceptions=False).output.splitlines()
    assert [line.split("\t")[1:3] for line in lines[1:5]] == [
        ["squared", "40"],
        ["squared", "60"],
        ["weighted", "40"],
        ["weighted", "60"],
    ]
    assert [line.split(":")[0] for line in lines[5:]] == ["# crop, squared", "# crop, weighted"]
