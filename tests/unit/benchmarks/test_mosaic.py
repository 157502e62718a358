"""A mosaic holds its crops as they were, mirrored or turned."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from click.testing import CliRunner

from benchmarks.mosaic import crops, main, mosaic
from sgicodec import read

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"


def test_crops_are_the_whole_cells() -> None:
    pixels = np.arange(7 * 5 * 3, dtype=np.uint8).reshape(7, 5, 3)
    found = crops(pixels, 2)
    assert len(found) == 6
    np.testing.assert_array_equal(found[-1], pixels[4:6, 2:4])


def test_every_cell_is_a_crop_turned_another_way() -> None:
    cells = list(np.random.default_rng(0).integers(0, 256, (3, 4, 4, 1), np.uint8))
    out = mosaic(cells, 19)
    assert out.shape == (16, 16, 1)
    found = [out[y : y + 4, x : x + 4, 0] for y in range(0, 16, 4) for x in range(0, 16, 4)]
    np.testing.assert_array_equal(found[1], cells[1][..., 0])
    np.testing.assert_array_equal(found[4], cells[1][:, ::-1, 0])
    np.testing.assert_array_equal(found[8], np.rot90(cells[2][..., 0]))


def test_the_command_writes_a_picture(tmp_path: Path) -> None:
    out = tmp_path / "mosaic.tif"
    arguments = [str(out), str(PHOTO), "--side", "300", "--cell", "100"]
    assert "300×300 pixels of " in CliRunner().invoke(main, arguments, catch_exceptions=False).output
    np.testing.assert_array_equal(read(out).pixels[:100, :100], read(PHOTO).pixels[:100, :100])
    assert CliRunner().invoke(main, [str(out), str(PHOTO), "--cell", "5000"]).exit_code == 2
