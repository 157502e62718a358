"""Results survive the disk, a cut and nothing else."""

from __future__ import annotations

import dataclasses
import math
import tempfile
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
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "results.tsv")
        Results(path).append(row)
        assert list(Results(path).rows.values()) == [row]


@pytest.mark.parametrize("cut", [1, 10, 1000])
def test_a_cut_line_is_dropped_with_the_next_row(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "results.tsv"
    Results(path).append(ROW)
    line = path.read_text().splitlines(keepends=True)[-1]
    with path.open("a") as file:
        file.write(line[: max(1, len(line) - cut)])
    before = path.read_text()
    resumed = Results(path)
    assert list(resumed.rows.values()) == [ROW]
    assert path.read_text() == before
    other = dataclasses.replace(ROW, settings="quality=60")
    resumed.append(other)
    assert list(Results(path).rows.values()) == [ROW, other]


def test_a_broken_line_is_named(tmp_path: Path) -> None:
    path = tmp_path / "results.tsv"
    Results(path).append(ROW)
    path.write_text(path.read_text() + "a\tb\n")
    with pytest.raises(UsageError, match="line 3 is no result: 2 values"):
        Results(path)
