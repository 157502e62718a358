"""Rows of the paper's tables on disk: what is written comes back, and rows that exist are not measured again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.paper.rows import PaperResults, PaperRow
from sgicodec.errors import UsageError

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


def test_a_line_holds_the_whole_row() -> None:
    assert PaperRow.from_line(ROW.to_line()) == ROW
    unknown = replace(ROW, bytes=None, ssim=None, parts="")
    assert PaperRow.from_line(unknown.to_line()) == unknown
    assert ROW.part_bytes == {"x_a": 1.5, "f_a": 20.0}
    assert unknown.part_bytes == {}


def test_a_run_that_was_cut_short_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "paper.tsv"
    results = PaperResults(path)
    results.append(ROW)
    results.append(replace(ROW, setting="20"))
    with path.open("a") as file:
        file.write("a.png\t0badc")
    again = PaperResults(path)
    assert list(again.rows.values()) == [ROW, replace(ROW, setting="20")]
    assert path.read_text().endswith("0badc")
    again.append(replace(ROW, setting="5"))
    assert len(PaperResults(path).rows) == 3


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


@pytest.mark.parametrize(
    ("text", "complaint"),
    [("name\tvalue\n", "other columns"), ("".join([PaperResults.__doc__ or "", "\n"]), "other columns")],
)
def test_another_file_is_refused(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "paper.tsv"
    path.write_text(text)
    with pytest.raises(UsageError, match=complaint):
        PaperResults(path)


def test_a_broken_line_is_named(tmp_path: Path) -> None:
    path = tmp_path / "paper.tsv"
    PaperResults(path).append(ROW)
    path.write_text(path.read_text() + "a\tb\n")
    with pytest.raises(UsageError, match="line 3 is no result: 2 values"):
        PaperResults(path)
