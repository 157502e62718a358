"""LPIPS: what its network is given, and that there is none without its package or its weights."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.paper import learned_distance as module
from benchmarks.paper.learned_distance import learned_distance

BLACK, WHITE = (np.full((8, 12, 3), value, np.uint8) for value in (0, 255))


@pytest.fixture(autouse=True)
def afresh() -> Iterator[None]:
    module._network.cache_clear()
    yield
    module._network.cache_clear()


def install(monkeypatch: pytest.MonkeyPatch, network: Any) -> None:
    monkeypatch.setattr(module, "find_spec", lambda name: object())
    monkeypatch.setitem(sys.modules, "lpips", SimpleNamespace(LPIPS=network))


def test_without_its_package_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    assert learned_distance(BLACK, WHITE) is None


def test_without_weights_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def fetch(**options: object) -> None:
        raise ConnectionError("no network here")

    install(monkeypatch, fetch)
    assert learned_distance(BLACK, WHITE) is None


def test_the_network_gets_planes_from_minus_one_to_one(monkeypatch: pytest.MonkeyPatch) -> None:
    torch = pytest.importorskip("torch")
    seen = []

    def compare(*pictures: Any) -> Any:
        seen.extend(pictures)
        return torch.tensor([[[[0.25]]]])

    install(monkeypatch, lambda **options: SimpleNamespace(eval=lambda: compare))
    assert learned_distance(BLACK, WHITE) == 0.25
    assert [tuple(picture.shape) for picture in seen] == [(1, 3, 8, 12)] * 2
    assert [picture.unique().tolist() for picture in seen] == [[-1.0], [1.0]]
