"""What tests of several parts share, and what holds for every test."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from children import end_children
from clock import Clock
from hypothesis import HealthCheck
from hypothesis import settings as hypothesis_settings

from sgicodec import EncodeSettings, read, write

DATA = Path(__file__).parent / "data"

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
    blocked = signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    yield
    signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
    signal.signal(signal.SIGINT, handler)


@pytest.fixture(autouse=True)
def _no_process_left(_interruptible: None) -> Iterator[None]:
    """Ends the processes that a test started and left behind, and fails it."""
    yield
    assert end_children() == {}


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """What time.monotonic shows; it stands still unless the test turns it."""
    mine = Clock()
    monkeypatch.setattr(time, "monotonic", mine)
    return mine


@pytest.fixture(scope="session")
def settings() -> EncodeSettings:
    """Short fits of small tiles, and an overview."""
    return EncodeSettings(steps=8, tile=64, overview=True)


@pytest.fixture(scope="session")
def photo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of 150×100 pixels of a photograph: six small tiles."""
    picture = read(DATA / "kodim23.png")
    path = tmp_path_factory.mktemp("photo") / "photo.png"
    write(replace(picture, pixels=np.ascontiguousarray(picture.pixels[180:280, 100:250])), path)
    return path
