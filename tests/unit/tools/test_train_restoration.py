"""Short trainings of networks of restoration on streams of two small crops."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sgicodec.device import ONE_THREAD
from sgicodec.encoder.settings import Tune

torch = pytest.importorskip("torch")
from tools.restoration_file import RestorationNet, file_of, network_of  # noqa: E402
from tools.train_restoration import (  # noqa: E402
    TRAININGS,
    Example,
    Loss,
    examples_of,
    loss_of,
    make_streams,
    shown,
    train,
)

DATA = Path(__file__).parents[2] / "data"


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pictures")
    for name in ("kodim13", "kodim23"):
        with Image.open(DATA / f"{name}.png") as picture:
            picture.crop((200, 100, 328, 228)).save(folder / f"{name}.png")
    return folder


SHORT = {
    "psnr": replace(TRAININGS["psnr"], qualities=(60, 80), effort=1, side=48, batch=4, rate=1e-2),
    "visual": replace(TRAININGS["visual"], qualities=(60, 80), effort=1, side=128, batch=2),
}
"""For the eye, crops are whole: scores of small ones are others."""


def taught(pictures: Path, streams: Path, tune: Tune) -> list[Example]:
    make_streams(pictures, streams, tune, SHORT[tune], ONE_THREAD)
    return examples_of(pictures, streams, ONE_THREAD)


def mean_loss(network: RestorationNet, examples: list[Example], loss: Loss) -> float:
    with torch.no_grad():
        return float(np.mean([float(loss(own, shown(network, [own])[0])) for own in examples]))


def lowered(network: RestorationNet, examples: list[Example], tune: Tune, steps: int) -> float:
    """How much lower a short training makes the loss of whole pictures, in the integers of the file."""
    loss = loss_of(tune)
    before = mean_loss(network, examples, loss)
    gains = train(network, examples, loss, SHORT[tune], steps, rounds=0.5)
    assert len(gains) == steps
    trained = network_of(file_of(network))
    trained.rounds = True
    return before - mean_loss(trained, examples, loss)


def test_training_for_squared_error_lowers_it(pictures: Path, tmp_path: Path) -> None:
    torch.manual_seed(1)
    examples = taught(pictures, tmp_path, "psnr")
    assert [example.name for example in examples] == ["kodim13"] * 2 + ["kodim23"] * 2
    assert lowered(RestorationNet(8, 2), examples, "psnr", 100) > 0.005
