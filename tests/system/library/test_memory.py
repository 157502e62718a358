"""What a process takes in memory: decoded tiles up to cache_bytes, and no tile that may need more than tile_bytes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from little_memory import printed
from repeated_tiles import TILE, repeated_tiles

import sgicodec

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads /proc"),
]

MIB = 1 << 20
ROWS, COLUMNS = 8, 128
READER = r"""
import ctypes, json, re
from pathlib import Path
import numpy as np
from library import Library, LibraryError, Options
path, library, side, cache_bytes, tile_bytes = {arguments!r}
stream = Library(Path(library)).open(Path(path).read_bytes(), Options(ctypes.sizeof(Options), 1, cache_bytes,
                                                                    tile_bytes=tile_bytes))
peak = lambda: int(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1])
info, refused, before = stream.info(), "", peak()
try:
    for y in range(0, info.height, side):
        for x in range(0, info.width, side):
            stream.draw(x=x, y=y, width=side, height=side, sample=0)
except LibraryError as error:
    refused = error.status
print(json.dumps([refused, (peak() - before) << 10]))
"""


def drawn(path: Path, library: Path, side: int, cache_bytes: int = 0, tile_bytes: int = 0) -> tuple[str, int]:
    """The status that a process ends with which draws all of a stream, by squares, and the bytes that it grew by."""
    refused, grown = json.loads(
        printed(READER.format(arguments=(str(path), str(library), side, cache_bytes, tile_bytes)))
    )
    return refused, grown


@pytest.fixture(scope="module")
def built(prefix: Path) -> Path:
    return prefix / "lib" / "libsgi.so"


def test_decoded_tiles_take_no_more_than_the_cache(built: Path, tmp_path: Path) -> None:
    """1,024 tiles of 53 kB: all are kept, or a ninth of them."""
    path = tmp_path / "a.sgi"
    path.write_bytes(repeated_tiles(ROWS, COLUMNS))
    _, all_of_them = drawn(path, built, 4 * TILE)
    refused, some = drawn(path, built, 4 * TILE, cache_bytes=6 * MIB)
    assert refused == ""
    assert all_of_them > 50 * MIB
    assert some < (6 + 6) * MIB


def test_a_tile_that_may_need_too_much_is_not_decoded(built: Path, tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (1024, 1024, 3), np.uint8)
    path = tmp_path / "a.sgi"
    path.write_bytes(sgicodec.encode(noise, quality=75, texture=False, steps=2, tile=0, rdoq=False))
    accepted, grown = drawn(path, built, 1024)
    refused, little = drawn(path, built, 1024, tile_bytes=MIB)
    assert (accepted, refused) == ("", "limit")
    assert grown > 32 * MIB
    assert little < 8 * MIB
