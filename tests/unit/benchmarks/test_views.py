"""Small views are measured against the whole model and the averaged source."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from click.testing import CliRunner

from benchmarks.views import averaged, main
from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.image import write

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_means_of_blocks() -> None:
    pixels = np.arange(7 * 5 * 3, dtype=np.uint8).reshape(7, 5, 3)
    found = averaged(pixels, 2)
    assert found.shape == (3, 2, 3)
    np.testing.assert_allclose(found[1, 1], pixels[2:4, 2:4].astype(float).mean(axis=(0, 1)) / 255, rtol=1e-6)


def test_two_rows_for_each_scale(tmp_path: Path) -> None:
    picture = read(PHOTO)
    picture = replace(picture, pixels=np.ascontiguousarray(picture.pixels[:200, :300]))
    source, stream = tmp_path / "in.png", tmp_path / "in.sgi"
    write(picture, source)
    stream.write_bytes(encode_picture(picture, EncodeSettings(steps=60, tile=128, overview=True)).data)
    arguments = [str(stream), "--source", str(source), "--shrink", "7", "--shrink", "20", "--repeat", "1"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in result.output.splitlines() if "| 1/" in line]
    assert [row[:2] for row in rows] == [[scale, name] for scale in ("1/7", "1/20") for name in ("all", "as usual")]
    assert all((row[2] == "") == (row[1] == "all") for row in rows)
    assert rows[1][2] == "inf"
    assert rows[0][3] == rows[1][3]
    assert 20 < float(rows[3][2]) < 60
    assert float(rows[3][3]) > 20
