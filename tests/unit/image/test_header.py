from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sgicodec.errors import PictureError
from sgicodec.image import open_source, read
from sgicodec.metadata import ifd, tiff

Save = Callable[..., Path]


@pytest.mark.parametrize("open_it", [read, open_source])
def test_doubles_in_tiles_are_refused(tmp_path: Path, save: Save, open_it: Callable[[Path], object]) -> None:
    path = save(tmp_path / "x.tif", np.ones((20, 20, 1)), tile=(16, 16))
    with pytest.raises(PictureError, match="64-bit floats are in tiles"):
        open_it(path)


def _white_is_zero(path: Path) -> Path:
    """Change the photometric interpretation of a file that OpenImageIO wrote."""
    tiff.insert(path, None, None, None)
    data = path.read_bytes()
    (row,) = (
        row for row in ifd.rows(data, int.from_bytes(data[4:8], "little"), ifd.Layout("<", False)) if row.tag == 262
    )
    path.write_bytes(data[: row.at] + b"\0\0" + data[row.at + 2 :])
    return path


def test_white_is_zero(tmp_path: Path, save: Save) -> None:
    ramp = np.arange(0, 200, 2, dtype=np.uint8).reshape(10, 10, 1)
    np.testing.assert_array_equal(read(_white_is_zero(save(tmp_path / "x.tif", ramp))).pixels, 255 - ramp)
    deep = _white_is_zero(save(tmp_path / "y.tif", ramp.astype(np.uint16)))
    with pytest.raises(PictureError, match="0 is white in its 16-bit samples"):
        read(deep)
