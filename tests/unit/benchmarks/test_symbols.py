"""The gain of RDOQ, on a real crop in a few steps."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.symbols import main, searched, timed
from benchmarks.whole import measured
from sgicodec import EncodeSettings, encode, read, write
from sgicodec.picture import Picture
from sgicodec.rdoq import RdoqSettings

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"
SETTINGS = EncodeSettings(lmbda=0.01, steps=30, threads=1, rdoq=False)


@pytest.fixture(scope="module")
def crop() -> Picture:
    photo = read(PHOTO)
    return replace(photo, pixels=np.ascontiguousarray(photo.pixels[:96, :128]))


def test_the_cost_is_of_the_decoded_picture_and_the_file(crop: Picture) -> None:
    found = timed(crop, SETTINGS)
    error = found.whole.cost - 0.01 * 8 * len(found.whole.encoded.data)
    assert -10 * np.log10(error / crop.pixels.size) == pytest.approx(found.psnr, abs=0.1)  # found.psnr is of bytes


def test_a_search_starts_at_what_the_stream_costs(crop: Picture) -> None:
    encoded = encode(crop, SETTINGS)
    before, after, _ = searched(crop, encoded.data, 0.01, RdoqSettings(), 1)
    beside = (measured(crop, encoded).cost - before) / (0.01 * 8)
    assert 0 < beside < 120  # bytes of the header and the chunks
    assert after < before


def test_rows(
    crop: Picture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write(crop, tmp_path / "crop.png")
    settings = ["--lmbda", "0.01", "--steps", "30", "--threads", "1"]
    monkeypatch.setattr(sys, "argv", ["symbols", str(tmp_path / "crop.png"), *settings])
    main()
    heads, cells = (line.split("\t") for line in capsys.readouterr().out.splitlines())
    assert len(heads) == len(cells)
    assert float(cells[3]) < float(cells[2])
    monkeypatch.setattr(sys, "argv", ["symbols", str(tmp_path / "crop.png"), "deep=1", *settings])
    main()
    assert [line.split("\t")[0] for line in capsys.readouterr().out.splitlines()] == ["defaults", "deep=1"]
