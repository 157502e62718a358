"""What is built into the library is what lies in the package, and its checksums are zlib's."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

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


@given(st.binary(max_size=100), st.binary(max_size=100))
def test_checksums_are_those_of_zlib(data: bytes, more: bytes) -> None:
    assert _native.crc32(data) == zlib.crc32(data)
    assert _native.crc32(more, _native.crc32(data)) == zlib.crc32(data + more)
