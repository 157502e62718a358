"""The measurement with a codec whose bytes and errors are known."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec.bench.codec import Pixels8, RoundTrip
from sgicodec.bench.peers import PEERS
from sgicodec.bench.published import PUBLISHED
from sgicodec.bench.rows import Results
from sgicodec.bench.run import find_pictures, run_bench
from sgicodec.errors import SgiError

Image = pytest.importorskip("PIL.Image")


@dataclass
class Shifter:
    """Adds its quality to every sample and claims 100 bytes for each level of quality."""

    name: str = "shifter"
    ladder: tuple[float, ...] = (4, 2)
    release: str = "1.0"
    fails_at: float | None = None
    coded: list[tuple[str, float]] = field(default_factory=list)

    def version(self) -> str:
        return self.release

    def settings(self, quality: float) -> str:
        return f"shift={quality:g}"

    def round_trip(self, pixels: Pixels8, quality: float) -> RoundTrip:
        if quality == self.fails_at:
            raise SgiError("too hard")
        self.coded.append((str(pixels.shape), quality))
        return RoundTrip(b"x" * int(100 * quality), pixels + np.uint8(quality), 0.5, 0.25, 64.0)


@pytest.fixture
def pictures(tmp_path: Path) -> list[Path]:
    rng = np.random.default_rng(5)
    folder = tmp_path / "pictures"
    folder.mkdir()
    for name, shape in {"b.png": (20, 30, 3), "a.png": (16, 12)}.items():
        Image.fromarray(rng.integers(0, 200, shape, np.uint8)).save(folder / name)
    (folder / "notes.txt").write_text("no picture")
    return find_pictures([folder])


def test_each_point_becomes_a_row(pictures: list[Path], tmp_path: Path) -> None:
    lines: list[str] = []
    summary = run_bench(pictures, [Shifter()], tmp_path / "out", report=lines.append)
    rows = list(Results(tmp_path / "out" / "results.tsv").rows.values())
    assert rows == summary.rows
    assert [(row.picture, row.settings) for row in rows] == [
        (name, setting) for name in ("a.png", "b.png") for setting in ("shift=4", "shift=2")
    ]
    last = rows[-1]
    assert (last.width, last.height, last.bytes, last.quality) == (30, 20, 200, 2)
    assert last.bpp == pytest.approx(8 * 200 / 600)
    assert last.psnr == pytest.approx(20 * math.log10(255 / 2))
    assert last.luma_psnr == pytest.approx(20 * math.log10(255 / 2))
    assert (last.encode_seconds, last.decode_seconds, last.memory_mib) == (0.5, 0.25, 64.0)
    assert [line[:14] for line in lines] == ["1/2 a.png 12x1", "2/2 b.png 30x2"]
    assert "2 points measured, 0 already there" in lines[1]


def test_a_second_run_measures_only_what_is_new(pictures: list[Path], tmp_path: Path) -> None:
    first = run_bench(pictures, [Shifter()], tmp_path)
    again = Shifter()
    assert run_bench(pictures, [again], tmp_path).rows == first.rows
    assert again.coded == []
    longer = Shifter(ladder=(4, 3, 2))
    assert len(run_bench(pictures, [longer], tmp_path).rows) == 6
    assert [quality for _, quality in longer.coded] == [3, 3]
    for changed in (Shifter(release="1.1"), Shifter(name="other")):
        run_bench(pictures, [changed], tmp_path)
        assert len(changed.coded) == 4


def test_a_failing_point_does_not_end_the_run(pictures: list[Path], tmp_path: Path) -> None:
    lines: list[str] = []
    summary = run_bench(pictures, [Shifter(fails_at=2)], tmp_path, report=lines.append)
    assert [row.quality for row in summary.rows] == [4, 4]
    assert summary.failures == [f"{name}, shifter, shift=2: too hard" for name in ("a.png", "b.png")]
    assert summary.failures[0] in lines
    mended = Shifter()
    assert run_bench(pictures, [mended], tmp_path).failures == []
    assert [quality for _, quality in mended.coded] == [2, 2]


def test_published_curves_stand_beside_the_measured_ones(tmp_path: Path) -> None:
    kodak = Path(__file__).parents[2] / "data" / "kodim23.png"
    Image.fromarray(np.zeros((20, 30, 3), np.uint8)).save(tmp_path / "other.png")
    published = list(PUBLISHED.values())
    summary = run_bench([kodak], [replace(PEERS["jpeg"], ladder=(30, 90))], tmp_path / "out", published=published)
    assert summary.codecs == ["jpeg", "coolchic5"]
    ((delta,),) = (c.rates.values() for c in summary.comparisons if c.test == "coolchic5")
    assert -90 < delta.value < -40
    assert {row.codec for row in Results(tmp_path / "out" / "results.tsv").rows.values()} == {"jpeg"}
    assert run_bench([tmp_path / "other.png"], [Shifter()], tmp_path / "out", published=published).codecs == ["shifter"]
