"""A tiny picture for the benchmark of large ones, whose processes run in this one."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("PIL")
pytest.importorskip("imagecodecs")
pytest.importorskip("matplotlib")
from in_process import InProcess

from benchmarks.large import sgi, trips
from sgicodec.image import read, write
from sgicodec.picture import Picture

KODIM = Path(__file__).parents[3] / "data" / "kodim23.png"


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> InProcess:
    runner = InProcess()
    monkeypatch.setattr(sgi, "run_timed", runner)
    monkeypatch.setattr(trips, "run_timed", runner)
    return runner


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """176×132 pixels of a photograph."""
    path = tmp_path_factory.mktemp("large") / "tiny.png"
    write(Picture(read(KODIM).pixels[200:332, 100:276].copy(), "rgb", (0.0, 255.0)), path)
    return path
