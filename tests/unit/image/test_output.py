"""Files that cannot grow: every format ends with an ordinary error, and the process goes on."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from sgicodec import read, write
from sgicodec.errors import PictureError
from sgicodec.image.formats import FORMATS
from sgicodec.picture import Picture

MOST = 1 << 14


@contextmanager
def limited() -> Iterator[None]:
    """A block in which no file of this process may grow beyond 16 KiB. No fixture: pytest may report into a file."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def picture(extension: str) -> Picture:
    floats = extension in ("exr", "hdr", "pfm")
    samples = np.random.default_rng(1).integers(0, 256, (120, 160, 3), np.uint8)
    return Picture(samples.astype(np.float32), "rgb", (0.0, 255.0)) if floats else Picture(samples, "rgb", (0.0, 255.0))


@pytest.mark.parametrize("extension", [holder.extensions[0] for holder in FORMATS])
def test_a_file_that_cannot_grow(tmp_path: Path, extension: str) -> None:
    target = tmp_path / f"x.{extension}"
    target.write_bytes(b"what was there")
    with limited(), pytest.raises(PictureError, match=rf"x\.{extension}: ") as caught:
        write(picture(extension), target)
    assert ".sgicodec-" not in str(caught.value)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"what was there"]


def test_what_went_through_a_pipe_is_whole(tmp_path: Path) -> None:
    """More than a pipe holds, written at the end while the writer holds Python's lock."""
    samples = np.random.default_rng(2).integers(0, 256, (600, 500, 3), np.uint8)
    write(Picture(samples, "rgb", (0.0, 255.0)), tmp_path / "x.webp")
    assert (tmp_path / "x.webp").stat().st_size > 1 << 18
    np.testing.assert_array_equal(read(tmp_path / "x.webp").pixels, samples)
