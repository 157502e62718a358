"""LPIPS and DISTS: what their networks are given, and that there is none without packages or weights."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from sgicodec.metrics import learned
from sgicodec.metrics.perceptual import Perceived, perceived

NAMES = ["lpips", "dists"]
SEEN: list[Any] = []
RED, BLUE = (np.full((32, 40, 3), colour, np.uint8) for colour in ((255, 0, 51), (0, 51, 255)))


def distance(*pictures: Any) -> Any:
    SEEN[:] = pictures
    return torch.tensor([[[[0.25]]]])


@pytest.fixture
def weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder for weights. In place of the packages stand modules that take two pictures."""
    metric = {"net_type": "alex", "normalize": True}  # the network of the authors; 0 to 1
    urls = {
        f"{net}_Weights": SimpleNamespace(DEFAULT=SimpleNamespace(url=f"a/{net}.pth")) for net in ("AlexNet", "VGG16")
    }
    for name, content in {
        "torchvision": {"models": SimpleNamespace(**urls)},
        "torchmetrics.functional.image.dists": {"DISTSNetwork": lambda: distance},
        "torchmetrics.image.lpip": {
            "LearnedPerceptualImagePatchSimilarity": lambda **given: distance if given == metric else None
        },
    }.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    for package in ("torchmetrics", "torchmetrics.image", "torchmetrics.functional", "torchmetrics.functional.image"):
        monkeypatch.setitem(sys.modules, package, ModuleType(package))
    monkeypatch.setattr(learned, "find_spec", lambda name: object())
    monkeypatch.setattr(torch.hub, "get_dir", lambda: str(tmp_path))
    learned.network.cache_clear()
    (tmp_path / "checkpoints").mkdir()
    yield tmp_path / "checkpoints"
    learned.network.cache_clear()


@pytest.mark.parametrize(("name", "net"), [("lpips", "AlexNet"), ("dists", "VGG16")])
def test_planes_of_red_green_and_blue_from_zero_to_one(weights: Path, name: str, net: str) -> None:
    (weights / f"{net}.pth").touch()
    assert [known for known in NAMES if known in Perceived.available()] == [name]
    assert getattr(perceived(RED, BLUE[..., ::-1]), name) == 0.25  # the view of reversed channels too
    assert [tuple(picture.shape) for picture in SEEN] == [(1, 3, 32, 40)] * 2
    assert [picture[0, :, 0, 0].tolist() for picture in SEEN] == [
        pytest.approx([1, 0, 0.2]),
        pytest.approx([1, 0.2, 0]),
    ]
    assert name not in Perceived.available(side=31)


def test_without_weights_there_is_none(weights: Path) -> None:
    assert not set(NAMES) & set(Perceived.available())


def test_without_packages_there_is_none(weights: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(learned, "find_spec", lambda name: None if name == "torchvision" else object())
    assert learned.network("lpips") is None
