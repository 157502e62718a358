"""LPIPS is left out where its package is not installed, and 0 for equal pictures where it is."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from benchmarks.paper.learned_distance import _network, learned_distance


def test_without_its_package_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks.paper import learned_distance as module

    monkeypatch.setattr(module, "find_spec", lambda name: None)
    _network.cache_clear()
    assert learned_distance(np.zeros((64, 64, 3), np.uint8), np.zeros((64, 64, 3), np.uint8)) is None
    assert "lpips" not in sys.modules
    _network.cache_clear()


def test_equal_pictures_are_at_no_distance() -> None:
    pytest.importorskip("lpips")
    pixels = np.random.default_rng(0).integers(0, 256, (64, 64, 3), np.uint8)
    found = learned_distance(pixels, pixels)
    if found is None:
        pytest.skip("the weights of AlexNet cannot be had")
    assert found == pytest.approx(0, abs=1e-6)
    assert (learned_distance(pixels, 255 - pixels) or 0) > 0.1
