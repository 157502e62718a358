"""What overviews lose is measured against the whole model and the averaged source."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from click.testing import CliRunner

from sgicodec import EncodeSettings, encode, read
from sgicodec.bench.thumbnails import averaged, main
from sgicodec.image import write

PHOTO = Path(__file__).parent.parent / "data" / "kodim23.png"


def test_means_of_blocks() -> None:
    pixels = np.arange(7 * 5 * 3, dtype=np.uint8).reshape(7, 5, 3)
    found = averaged(pixels, 2)
    assert found.shape == (3, 2, 3)
    np.testing.assert_allclose(found[1, 1], pixels[2:4, 2:4].astype(float).mean(axis=(0, 1)) / 255, rtol=1e-6)


def test_a_row_for_each_scale_and_least_cell(tmp_path: Path) -> None:
    picture = read(PHOTO)
    picture = replace(picture, pixels=np.ascontiguousarray(picture.pixels[:200, :300]))
    source, stream = tmp_path / "in.png", tmp_path / "in.sgi"
    write(picture, source)
    stream.write_bytes(encode(picture, EncodeSettings(steps=60, tile=128, threads=1)).data)
    arguments = [str(stream), "--source", str(source), "--shrink", "7", "--shrink", "50", "--repeat", "1"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in result.output.splitlines() if "| 1/" in line]
    assert [row[:2] for row in rows[:6]] == [["1/7", name] for name in ("all *", "4", "8", "16", "32", "base alone")]
    assert [row[1] for row in rows[6:]] == ["all", "4", "8", "16", "32", "base alone *"]
    assert all((row[2] == "") == row[1].startswith("all") for row in rows)
    assert float(rows[0][3]) > float(rows[5][3]) + 3
