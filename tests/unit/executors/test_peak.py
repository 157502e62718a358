"""Peaks of memory: of this process, and of workers together."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.executors.peak import Peaks, own_peak
from sgicodec.executors.processes import ProcessExecutor

MIB = 1 << 20


def hungry(number: int, megabytes: int) -> int:
    return int(np.ones(megabytes * MIB, np.uint8).sum()) // MIB


def test_what_workers_take_together() -> None:
    peaks = Peaks()
    peaks.begin()
    for worker, peak in [(0, 5), (1, 7), (0, 3), (1, None)]:
        peaks.add(worker, peak)
    assert peaks.bytes == 12
    peaks.begin()
    peaks.add(0, 11)
    assert peaks.bytes == 12
    peaks.add(1, 2)
    assert peaks.bytes == 13


def test_workers_tell() -> None:
    pytest.importorskip("resource")
    alone = own_peak() or 0
    executor = ProcessExecutor(2)
    assert dict(executor.run(hungry, range(4), lambda number: 200)) == dict.fromkeys(range(4), 200)
    assert executor.peaks.bytes > 400 * MIB
    assert (own_peak() or 0) - alone < 100 * MIB
