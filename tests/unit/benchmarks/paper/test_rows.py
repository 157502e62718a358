"""Rows of the paper's tables: what is written comes back, and rows that exist are not measured again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from benchmarks.paper.rows import PaperResults, PaperRow

ROW = PaperRow(
    *("a.png", "0badcafe", "K", "10", "paper", "--seeds 5"),
    width=40,
    height=30,
    seeds=5,
    gaussians=50,
    steps=60,
    bytes=1234,
    psnr=28.125,
    ssim=0.9,
    fit_seconds=1.5,
    parts="x_a=1.5;f_a=20",
    version="0.1.0+abc",
)


def test_parts_are_numbers() -> None:
    assert ROW.part_bytes == {"x_a": 1.5, "f_a": 20.0}
    assert replace(ROW, parts="").part_bytes == {}


def test_rows_come_back(tmp_path: Path) -> None:
    results, unknown = PaperResults(tmp_path / "paper.tsv"), replace(ROW, setting="20", bytes=None, ssim=None, parts="")
    results.append(ROW)
    results.append(unknown)
    assert list(PaperResults(tmp_path / "paper.tsv").rows.values()) == [ROW, unknown]


def test_another_table_takes_what_is_measured(tmp_path: Path) -> None:
    results = PaperResults(tmp_path / "paper.tsv")
    results.append(ROW)
    for_lambda = ("b.png", *ROW.key[1:2], "λ", "0.001", *ROW.key[4:])
    assert results.find(for_lambda) == replace(ROW, picture="b.png", table="λ", setting="0.001")
    assert results.find(("b.png", "other crc", *for_lambda[2:])) is None
    assert len(PaperResults(tmp_path / "paper.tsv").rows) == 2


def test_without_a_file_rows_are_kept_in_memory() -> None:
    results = PaperResults()
    results.append(ROW)
    assert results.find(ROW.key) == ROW
