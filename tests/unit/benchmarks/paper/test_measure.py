"""Jobs on a tiny picture: what they measure is of the file and of the picture that it decodes to."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.paper.jobs import Job, Method, PaperFit
from benchmarks.paper.measure import Bench, bilinear, reduced
from sgicodec import imread
from sgicodec.bench.run import Sample, load_sample
from sgicodec.errors import SgiError
from sgicodec.metrics.psnr import psnr

KODIM = Path(__file__).parents[3] / "data" / "kodim23.png"
FIT = PaperFit(seeds=12, steps=6)


@pytest.fixture(scope="module")
def sample() -> Sample:
    return Sample.of("tiny", np.ascontiguousarray(load_sample(KODIM).pixels[200:251, 100:166]))


@pytest.fixture
def bench(tmp_path: Path, processes: object) -> Bench:
    return Bench(tmp_path, 1, quick=True, version="test")


def test_a_stream_is_measured_as_it_lies_on_disk(bench: Bench, sample: Sample) -> None:
    job = Job("decode", "low", FIT)
    row = bench.row(job, sample)
    (path,) = bench.folder.iterdir()
    assert row.key == job.key("tiny", sample.crc)
    assert row.bytes == path.stat().st_size
    assert row.psnr == psnr(sample.pixels, imread(path))
    assert (row.seeds, row.gaussians, row.steps) == (12, 120, 6)
    assert (row.fit_seconds, row.cpu_seconds, row.peak_mib) == (1.5, 1.25, 64.0)
    assert sum(row.part_bytes.values()) < row.bytes
    assert {"x_a", "f_a", "{s_o, s_a}", "δ", "H", "MLPs"} <= set(row.part_bytes)
    assert row.decode_seconds is not None
    assert row.decode_seconds > 0
    assert bench.row(job, sample).psnr == row.psnr
    assert len(bench.coded) == 1


def test_others_have_the_bytes_or_the_psnr_of_the_stream(bench: Bench, sample: Sample) -> None:
    stream = bench.row(Job("comparison", "low", FIT), sample)
    assert stream.bytes is not None
    others = (Method.JPEG, Method.DEFAULT_BYTES, Method.DEFAULT_PSNR)
    rows = {method: bench.row(Job("comparison", "low", FIT, method), sample, stream) for method in others}
    assert all(row.bytes is not None for row in rows.values())
    assert max(rows[Method.JPEG].bytes or 0, rows[Method.DEFAULT_BYTES].bytes or 0) <= stream.bytes
    assert rows[Method.DEFAULT_PSNR].psnr > stream.psnr - 0.1
    assert {row.gaussians for row in rows.values()} == {0}


def test_without_a_stream_nothing_can_stand_beside(bench: Bench, sample: Sample) -> None:
    with pytest.raises(SgiError, match="no stream of the paper profile"):
        bench.row(Job("comparison", "low", FIT, Method.JPEG), sample, None)


@pytest.mark.parametrize("factor", [2, 8])
def test_enlarged_pictures_are_compared_at_their_size(bench: Bench, sample: Sample, factor: int) -> None:
    rows = [bench.row(Job("super-resolution", "×", FIT, m, factor), sample) for m in (Method.PAPER, Method.BILINEAR)]
    assert {(row.width, row.height) for row in rows} == {(8 * factor, 6 * factor)}
    small = reduced(sample.pixels[:48, :64], 8)
    original = reduced(sample.pixels[:48, :64], 8 // factor)
    assert rows[1].psnr == psnr(original, bilinear(small, factor))
    assert rows[1].bytes is None
    assert rows[0].bytes


def test_an_exact_fit_leaves_no_file(bench: Bench, sample: Sample) -> None:
    row, longer = (bench.row(Job("exact", "400", PaperFit(40, steps), Method.EXACT), sample) for steps in (10, 120))
    assert row.bytes is None
    assert longer.psnr > row.psnr + 3
    assert list(bench.folder.iterdir()) == []


def test_reduction_takes_means_of_squares() -> None:
    pixels = np.arange(4 * 4 * 3, dtype=np.uint8).reshape(4, 4, 3)
    assert np.array_equal(reduced(pixels, 4)[0, 0], np.rint(pixels.mean(axis=(0, 1))))
    assert np.array_equal(reduced(pixels, 1), pixels)
    assert (bilinear(np.full((2, 3, 3), 7, np.uint8), 4) == 7).all()
    assert bilinear(np.zeros((2, 3, 3), np.uint8), 4).shape == (8, 12, 3)
