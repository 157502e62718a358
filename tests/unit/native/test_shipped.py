"""What is built into the library is what lies in the package."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest

import sgicodec
from sgicodec import _native

BITSTREAM = Path(sgicodec.__file__).parent / "bitstream"
FILES = sorted(BITSTREAM.glob("**/*.bin"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_file_is_in_the_library(path: Path) -> None:
    kind = path.stem.rstrip("0123456789")
    data = path.read_bytes()
    expected = zlib.decompress(data) if kind == "texture" else data
    assert _native.shipped(kind, int(path.stem.removeprefix(kind) or 0)) == expected
