"""What peers coded is kept by codec, version, settings and picture."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from sgicodec.bench.cache import PeerCache
from sgicodec.bench.rows import Row

ROW = Row(
    *("jpeg", "turbo 3", "quality=50", "a.png", "0123abcd"),
    **{"width": 8, "height": 8, "quality": 50.0, "bytes": 100, "bpp": 12.5, "psnr": 30.0, "luma_psnr": 31.0},
    **{"ssim": 0.9, "ms_ssim": 0.99, "encode_seconds": 1.0, "decode_seconds": 1.0, "memory_mib": None},
)


def test_rows_are_found_by_another_run_under_another_name_of_the_picture(tmp_path: Path) -> None:
    PeerCache(tmp_path / "cache").keep(ROW)
    again = PeerCache(tmp_path / "cache")
    assert again.row(ROW.key) == ROW
    renamed = dataclasses.replace(ROW, picture="b.png")
    assert again.row(renamed.key) == renamed


@pytest.mark.parametrize("field", ["codec", "version", "settings", "crc"])
def test_anything_else_is_another_point(tmp_path: Path, field: str) -> None:
    cache = PeerCache(tmp_path)
    cache.keep(ROW)
    other = dataclasses.replace(ROW, **{field: "other"})
    assert cache.row(other.key) is None
    assert cache.stream(ROW.key, lambda: b"first") == b"first"
    assert cache.stream(other.key, lambda: b"second") == b"second"


def test_streams_are_coded_once(tmp_path: Path) -> None:
    coded: list[int] = []

    def encode() -> bytes:
        coded.append(1)
        return b"stream"

    assert PeerCache(tmp_path).stream(ROW.key, encode) == PeerCache(tmp_path).stream(ROW.key, encode) == b"stream"
    assert coded == [1]


def test_a_stream_that_fails_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        PeerCache(tmp_path).stream(ROW.key, lambda: bytes(1 // 0))
    assert PeerCache(tmp_path).stream(ROW.key, lambda: b"whole") == b"whole"
