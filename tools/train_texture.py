"""Trains the adaptive models with which every texture layer begins, on the layers of many pictures.

    python -m tools.train_texture PICTURES_DIR OUT.bin

Each picture is encoded for squared error and for the eye, at several qualities. Layers are coded one after the other by
models that go on learning; since they remember no more than their last 150 bits, this is done in many orders, and their
mean is taken. At the end the models forget how sure they are, so that they adapt, and are rounded.
"""

from __future__ import annotations

import argparse
import random
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec._native import TextureModels
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.effort import Tune
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.picture import Picture

__all__ = ["compact", "main", "train"]

QUALITIES: dict[Tune, tuple[float, ...]] = {"psnr": (30, 42, 54, 66), "visual": (45, 57, 70, 83)}
EFFORT, ORDERS = 4, 24
SETS = 1952
"""Of weights (docs/format.md, "Start")."""
SETTLED = 16
"""Bits that a model has seen at most when a layer begins."""


class State(NamedTuple):
    """Of all models and weights: P in 2^-16 and bits seen of each, and weights, flat."""

    probability: NDArray[np.int64]
    seen: NDArray[np.int64]
    weights: NDArray[np.int32]

    @staticmethod
    def of(data: bytes) -> State:
        """That of `TextureModels.state`."""
        count = (len(data) - 16 * SETS) // 3
        lower, upper, seen = np.frombuffer(data, np.uint8, 3 * count).reshape(3, count).astype(np.int64)
        return State(lower | upper << 8, seen, np.frombuffer(data[3 * count :], "<i4"))

    def data(self) -> bytes:
        """As `TextureModels` takes it."""
        parts = self.probability & 255, self.probability >> 8, self.seen
        return b"".join(part.astype(np.uint8).tobytes() for part in parts) + self.weights.astype("<i4").tobytes()


def layers(picture: Picture) -> Iterator[TextureSymbols]:
    """The texture of a picture's streams."""
    for tune, qualities in QUALITIES.items():
        for quality in qualities:
            settings = EncodeSettings(quality=quality, effort=EFFORT, tune=tune, tile=0, overview=False)
            with open_stream(encode_picture(picture, settings).data) as stream:
                if stream.model.texture is not None:
                    yield stream.model.texture


def train(paths: list[Path]) -> State:
    """The mean of models after all pictures, in many orders: of the logarithms of odds, and of weights."""
    everything = [layer for path in paths for layer in layers(read(path))]
    states = []
    for order in range(ORDERS):
        random.Random(order).shuffle(everything)
        models = TextureModels()
        for layer in everything:
            models.learn(layer.log_size, layer.contrast, layer.symbols, layer.size, layer.steps.has_contrast)
        models.settle(SETTLED)
        states.append(State.of(models.state()))
    logits = np.mean([_logits(state.probability) for state in states], axis=0)
    probability = np.rint(65536 / (1 + np.exp(-logits))).astype(np.int64)
    weights = np.rint(np.mean([state.weights for state in states], axis=0)).astype(np.int32)
    return State(probability, np.max([state.seen for state in states], axis=0), weights)


def _logits(probability: NDArray[np.int64]) -> NDArray[np.float64]:
    inside = probability.clip(16, 65519)
    return np.asarray(np.log(inside / (65536 - inside)))


def compact(state: State) -> State:
    """A state whose probabilities are a quarter of a logit apart, with few different lower bytes: packed, it takes half
    the bytes, and layers cost what they did.
    """
    levels = np.rint(65536 / (1 + np.exp(-np.arange(-7.5, 7.75, 0.25)))).astype(np.int64)
    levels = np.where(levels < 256, levels & ~15, np.where(levels >= 65280, levels | 15, levels & ~255 | 128))
    levels = np.unique(levels.clip(16, 65519))
    apart = np.abs(np.subtract.outer(_logits(state.probability), _logits(levels)))
    found = levels[apart.argmin(axis=1)]
    found[state.seen == 0] = 32768
    return state._replace(probability=found)


def main() -> None:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    options.out.write_bytes(zlib.compress(compact(train(sorted(options.pictures.glob("*.png")))).data(), 9))


if __name__ == "__main__":
    main()
