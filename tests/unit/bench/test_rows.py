"""Results survive the disk, a cut and nothing else."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.bench.rows import Results, Row
from sgicodec.errors import UsageError

ROW = Row(
    codec="jpeg",
    version="libjpeg-turbo 3",
    settings="quality=50 4:2:0",
    picture="a b.png",
    crc="0123abcd",
    width=768,
    height=512,
    quality=50.0,
    bytes=12345,
    bpp=8 * 12345 / (768 * 512),
    psnr=30.123456789,
    luma_psnr=math.inf,
    ssim=0.9,
    ms_ssim=1 / 3,
    encode_seconds=1e-5,
    decode_seconds=2.5,
    memory_mib=None,
)


@given(st.floats(0, 1e9), st.integers(1, 10**12), st.none() | st.floats(0, 1e6))
def test_rows_come_back_exactly(psnr: float, size: int, memory: float | None) -> None:
    row = dataclasses.replace(ROW, psnr=psnr, bytes=size, memory_mib=memory)
    assert Row.from_line(row.to_line()) == row


def test_key_is_what_was_measured_not_what_came_out() -> None:
    assert dataclasses.replace(ROW, bytes=1, psnr=2, encode_seconds=3).key == ROW.key
    for field in ("codec", "version", "settings", "picture", "crc"):
        assert dataclasses.replace(ROW, **{field: "other"}).key != ROW.key


def test_results_are_read_again(tmp_path: Path) -> None:
    other = dataclasses.replace(ROW, settings="quality=60")
    results = Results(tmp_path / "results.tsv")
    results.append(ROW)
    results.append(other)
    again = Results(tmp_path / "results.tsv")
    assert again.rows == results.rows == {ROW.key: ROW, other.key: other}
    header, first, second = (tmp_path / "results.tsv").read_text().splitlines()
    assert header.split("\t")[:5] == ["codec", "version", "settings", "picture", "crc"]
    assert first.split("\t")[8] == "12345"
    assert second.split("\t")[2] == "quality=60"


@pytest.mark.parametrize("cut", [1, 10, 1000])
def test_a_cut_line_is_dropped_and_the_file_stays_sound(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "results.tsv"
    Results(path).append(ROW)
    whole = path.read_text()
    path.write_text((whole + ROW.to_line() + "\n")[: -min(cut, len(ROW.to_line()))])
    resumed = Results(path)
    assert list(resumed.rows.values()) == [ROW]
    other = dataclasses.replace(ROW, settings="quality=60")
    resumed.append(other)
    assert list(Results(path).rows.values()) == [ROW, other]


def test_a_file_cut_inside_its_header_starts_again(tmp_path: Path) -> None:
    path = tmp_path / "results.tsv"
    path.write_text("codec\tvers")
    Results(path).append(ROW)
    assert list(Results(path).rows.values()) == [ROW]


@pytest.mark.parametrize("text", ["name\tvalue\n", "a shopping list"])
def test_a_foreign_file_is_refused_and_left_alone(tmp_path: Path, text: str) -> None:
    path = tmp_path / "results.tsv"
    path.write_text(text)
    with pytest.raises(UsageError, match="other columns"):
        Results(path)
    assert path.read_text() == text


def test_a_damaged_line_is_named(tmp_path: Path) -> None:
    path = tmp_path / "results.tsv"
    Results(path).append(ROW)
    for damage in ("half\ta\trow\n", ROW.to_line().replace("12345", "many") + "\n"):
        path.write_text(path.read_text().splitlines(keepends=True)[0] + damage)
        with pytest.raises(UsageError, match="line 2 is no result"):
            Results(path)


OLD_COLUMNS = 17  # before SSIMULACRA 2 and Butteraugli


def old_file(path: Path) -> Path:
    path.write_text("\t".join(vars(ROW))[: -len("\tssimulacra2\tbutteraugli")] + "\n" + ROW.to_line()[:-2] + "\n")
    return path


def test_files_without_perceptual_scores_are_read_and_left_alone(tmp_path: Path) -> None:
    path = old_file(tmp_path / "results.tsv")
    before = path.read_bytes()
    assert before.count(b"\t") == 2 * (OLD_COLUMNS - 1)
    assert list(Results(path).rows.values()) == [ROW]
    assert (ROW.ssimulacra2, ROW.butteraugli) == (None, None)
    assert path.read_bytes() == before


def test_such_a_file_gets_the_columns_with_the_next_row(tmp_path: Path) -> None:
    path = old_file(tmp_path / "results.tsv")
    other = dataclasses.replace(ROW, settings="quality=60", ssimulacra2=-7.5, butteraugli=1.25)
    results = Results(path)
    results.append(other)
    results.append(dataclasses.replace(other, settings="quality=70"))
    assert list(Results(path).rows.values()) == list(results.rows.values())
    assert [line.split("\t")[-2:] for line in path.read_text().splitlines()] == [
        ["ssimulacra2", "butteraugli"],
        ["", ""],
        ["-7.5", "1.25"],
        ["-7.5", "1.25"],
    ]
