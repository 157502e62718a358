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


@pytest.mark.parametrize("columns", [17, 19])
def test_files_of_older_versions_get_the_later_columns_with_the_next_row(tmp_path: Path, columns: int) -> None:
    path = tmp_path / "results.tsv"
    names = [field.name for field in dataclasses.fields(Row)]
    old = ["\t".join(line.split("\t")[:columns]) for line in ("\t".join(names), ROW.to_line())]
    path.write_text("\n".join(old) + "\n")
    results = Results(path)
    assert list(results.rows.values()) == [ROW]
    assert path.read_text().startswith(old[0] + "\n")
    other = dataclasses.replace(ROW, settings="quality=60", flip=0.1)
    results.append(other)
    assert list(Results(path).rows.values()) == [ROW, other]


@pytest.mark.parametrize("text", ["name\tvalue\n", "a shopping list"])
def test_a_foreign_file_is_refused_and_left_alone(tmp_path: Path, text: str) -> None:
    path = tmp_path / "results.tsv"
    path.write_text(text)
    with pytest.raises(UsageError, match="other columns"):
        Results(path)
    assert path.read_text() == text
