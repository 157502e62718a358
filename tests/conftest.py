"""What tests of several parts share, and what holds for every test."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from children import end_children
from data_files import crop, geotiff
from hypothesis import HealthCheck
from hypothesis import settings as hypothesis_settings

from sgicodec import EncodeSettings, imwrite, write

# Workers of pytest-xdist share the processors: a pool of threads in each would only wait for the others.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# No deadline and no complaint about slow draws: how long a test takes depends on what else the machine does.
for name, count in {"fast": 25, "full": 100}.items():
    hypothesis_settings.register_profile(
        name, max_examples=count, deadline=None, suppress_health_check=[HealthCheck.too_slow]
    )
hypothesis_settings.load_profile("full")


@pytest.fixture(autouse=True)
def _interruptible() -> Iterator[None]:
    """SIGINT raises KeyboardInterrupt, even if pytest was started with it ignored; processes inherit that."""
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    has_mask = sys.platform != "win32"
    if has_mask:
        blocked = signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    yield
    if has_mask:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
    signal.signal(signal.SIGINT, handler)


@pytest.fixture(autouse=True)
def _no_process_left(_interruptible: None) -> Iterator[None]:
    """Ends the processes that a test started and left behind, and fails it."""
    yield
    assert end_children() == {}


@pytest.fixture(scope="session")
def settings() -> EncodeSettings:
    """Short fits of small tiles, and an overview."""
    return EncodeSettings(steps=8, tile=64, overview=True)


@pytest.fixture(scope="session")
def photo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of 150×100 pixels of a photograph: six small tiles."""
    path = tmp_path_factory.mktemp("photo") / "photo.png"
    write(crop("kodim23", np.s_[180:280, 100:250]), path)
    return path


@pytest.fixture(scope="session")
def pyramid(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stream of 520×300 pixels in six tiles: three levels."""
    path = tmp_path_factory.mktemp("pyramid") / "pyramid.sgi"
    y, x = np.mgrid[:300, :520]
    pixels = np.stack([x % 256, y % 256, (x + y) // 5], axis=2).astype(np.uint8)
    imwrite(path, pixels, steps=2, tile=256, rdoq=False, overview=False)
    return path


@pytest.fixture(scope="session")
def on_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stream of heights on a map, float32, 610×300 pixels of ten metres in six tiles, some without a value."""
    folder = tmp_path_factory.mktemp("map")
    y, x = np.mgrid[:300, :610]
    heights = (200 + 50 * np.sin(x / 90) + y / 4).astype(np.float32)
    heights[:60, :90] = -9999
    tif = geotiff(folder / "map.tif", heights[None], nodata=-9999)
    imwrite(folder / "map.sgi", tif, steps=2, tile=256, rdoq=False)
    return folder / "map.sgi"
