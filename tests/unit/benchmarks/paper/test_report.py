"""Tables from rows: means over pictures, shares, published figures beside."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.paper.jobs import TABLES, Method, Scope, jobs
from benchmarks.paper.report import means, report
from benchmarks.paper.rows import PaperRow

ROW = PaperRow(
    *("a.png", "a", "per-seed", "10", Method.PAPER.value, "--seeds 5"),
    width=200,
    height=100,
    seeds=500,
    gaussians=5000,
    steps=15_000,
    bytes=10_000,
    psnr=30.0,
    ssim=0.9,
    fit_seconds=120.0,
    cpu_seconds=240.0,
    decode_seconds=0.088,
    parts="x_a=1000;f_a=5000;{s_o, s_a}=500;δ=3000;H=100;MLPs=300;steps=100",
)
OTHER = replace(ROW, picture="b.png", crc="b", psnr=32.0, bytes=30_000, lpips=0.1)


def lines(text: str, start: str) -> list[list[str]]:
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith(start)]


def test_means_are_over_pictures_and_the_last_row_of_each() -> None:
    (one,) = means([replace(ROW, psnr=1.0), ROW, OTHER])
    assert (one.psnr, one.bytes, one.minutes, one.cpu_minutes) == (31.0, 20_000, 2.0, 4.0)
    assert one.of(lambda row: row.lpips) is None


def test_an_ablation_stands_beside_the_paper() -> None:
    rows = [ROW, replace(ROW, setting="20", bytes=9000, psnr=29.5)]
    found = lines(report(rows), "| 20 ")[0]
    assert found[:7] == ["20", "30.62", "0.91", "56.02", "34.57", "0.88", "53.37"]
    assert found[7:] == ["29.50", "0.9000", "0.90", "9,000", "2.00", "4.00"]


def test_a_fit_without_a_file_has_no_size() -> None:
    exact = replace(ROW, table="lambda", setting="0", method=Method.EXACT.value, bytes=None, ssim=None)
    assert lines(report([exact]), "| 0, fit")[0][5:] == ["30.00", "–", "–", "–", "2.00", "4.00"]


def test_components_are_shares_of_the_file() -> None:
    found = lines(report([replace(ROW, table="components", setting="1")]), "| 5,000 ")[0]
    assert found[1:4] == ["10.0 % (1,000)", "50.0 % (5,000)", "5.0 % (500)"]
    assert found[-2:] == ["1.0 % (100)", "10,000 bytes"]


def test_jpeg_stands_in_the_line_of_its_stream() -> None:
    rate = replace(ROW, table="rate-distortion", setting="1")
    jpeg = replace(rate, method=Method.JPEG.value, bytes=9_500, psnr=28.0)
    assert lines(report([rate, jpeg]), "| a.png ")[0][1:] == ["5,000", "4.000", "30.00", "3.800", "28.00"]


def test_pictures_have_their_own_lines_and_a_mean() -> None:
    exact = [replace(row, table="exact", setting="5,000", method=Method.EXACT.value) for row in (ROW, OTHER)]
    text = report(exact)
    assert [line[3] for line in lines(text, "| a.png") + lines(text, "| b.png") + lines(text, "| mean")] == [
        "30.00",
        "32.00",
        "31.00",
    ]


def test_runs_of_other_lengths_and_pictures_are_kept_apart() -> None:
    text = report([ROW, replace(ROW, steps=60), OTHER], each=True)
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings == ["## a.png, 15,000 steps", "## b.png, 15,000 steps", "## a.png, 60 steps"]


@pytest.mark.parametrize("table", TABLES)
def test_every_table_prints_all_that_it_measures(table: str) -> None:
    rows = []
    for job in jobs(table, 20_000, Scope(15_000)):
        seeds = job.fit.seeds
        key = job.key("a.png", "a")
        rows.append(replace(ROW, table=key[2], setting=key[3], method=key[4], options=key[5], seeds=seeds))
    text = report(rows)
    tables = [line for line in text.splitlines() if line.startswith("|")]
    assert len({line.count("|") for line in tables}) == 1
    assert "published" in text or "FGF2" in text
    assert report(rows[:1]) != text or len(rows) == 1
