"""Rows of the benchmark of time limits, of a real command on a small crop."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.limits import COLUMNS, main, numbers_of
from sgicodec import encode_picture, read, write
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import UsageError

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_a_row_for_each_limit_and_effort(tmp_path: Path) -> None:
    photo = read(PHOTO)
    crop = replace(photo, pixels=np.ascontiguousarray(photo.pixels[:64, :96]))
    path = tmp_path / "crop.png"
    write(crop, path)
    arguments = [str(path), "--limits", "1", "--efforts", "1", "--tile", "64", "--threads", "1"]
    lines = CliRunner().invoke(main, arguments, catch_exceptions=False).output.splitlines()
    rows = [dict(zip(COLUMNS, line.split("\t"), strict=True)) for line in lines[1:]]
    assert lines[0].split("\t") == list(COLUMNS)
    assert [row["asked"] for row in rows] == ["--time-limit 1", "--effort 1"]
    assert rows[1]["steps"] == "120"
    encoded = encode_picture(crop, EncodeSettings(effort=1, tile=64))
    error = np.square((crop.pixels - open_stream(encoded.data).picture().pixels.astype(float)) / 255).sum()
    cost = (error + encoded.lmbda * 8 * len(encoded.data)) / (64 * 96)
    assert float(rows[1]["cost"]) == pytest.approx(cost, abs=1e-6)


def test_what_is_no_number() -> None:
    assert numbers_of("20,0.5,", "--limits") == ["20", "0.5"]
    with pytest.raises(UsageError, match="--limits"):
        numbers_of("20,x", "--limits")
