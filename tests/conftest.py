"""What tests of several parts share."""

from __future__ import annotations

import time

import pytest
from clock import Clock


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """What time.monotonic shows; it stands still unless the test turns it."""
    mine = Clock()
    monkeypatch.setattr(time, "monotonic", mine)
    return mine
