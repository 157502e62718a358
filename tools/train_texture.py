"""Trains the adaptive models with which every texture layer begins, on the layers of many pictures.

    python -m tools.train_texture PICTURES_DIR OUT.bin

Each picture is encoded for squared error and for the eye, each time at another quality; layers are coded one after
the other by models that go on learning. At the end the models forget how sure they are, so that they adapt, and are
rounded.
"""

from __future__ import annotations

import argparse
import zlib
from itertools import cycle
from pathlib import Path

import numpy as np

from sgicodec import read
from sgicodec._native import TextureModels
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.stages import fit_seeds
from sgicodec.encoder.tile.state import tile_of
from sgicodec.encoder.tile.texture_steps import TUNINGS, Masking
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.picture import Picture

__all__ = ["compact", "main", "train"]

QUALITIES = (25.0, 70.0, 40.0, 85.0, 55.0)
EFFORT = 2
SETS = 944
"""Of weights (docs/format.md, "Start")."""
SETTLED = 24
"""Bits that a model has seen at most when a layer begins."""


def layers(picture: Picture, quality: float) -> list[TextureSymbols]:
    """The texture of a picture, for squared error and for the eye, over the same seeds."""
    found = []
    settings = EncodeSettings(quality=quality, effort=EFFORT, tile=0)
    tile = tile_of(picture, stream_plan(Shape.of(picture), settings))
    state, search = fit_seeds(tile, tile.fit.lmbda).begin_texture()
    for tune in ("psnr", "visual"):
        tuning = TUNINGS[tune]
        steps = tuning.steps(tuning.step(state.lmbda), tile.spec.channels)
        offsets = Masking(tuning, tile.unit).offsets(steps)
        layer = search.at(steps, tuning.squared_steps, offsets)
        found += [] if layer is None else [layer]
    return found


def train(paths: list[Path]) -> TextureModels:
    """The models after all pictures."""
    models = TextureModels()
    for path, quality in zip(paths, cycle(QUALITIES), strict=False):
        for layer in layers(read(path), quality):
            models.learn(layer.log_size, layer.contrast, layer.symbols, layer.size, layer.steps.has_contrast)
    models.settle(SETTLED)
    return models


def compact(state: bytes) -> bytes:
    """A state whose probabilities are a quarter of a logit apart, with few different lower bytes: packed, it takes half
    the bytes, and layers cost what they did.
    """
    count = (len(state) - 16 * SETS) // 3
    lower, upper, seen = np.frombuffer(state, np.uint8, 3 * count).reshape(3, count).astype(np.int64)
    levels = np.rint(65536 / (1 + np.exp(-np.arange(-7.5, 7.75, 0.25)))).astype(np.int64)
    levels = np.where(levels < 256, levels & ~15, np.where(levels >= 65280, levels | 15, levels & ~255 | 128))
    levels = np.unique(levels.clip(16, 65519))
    logits = [np.log(p / (65536 - p)) for p in (np.clip(lower | upper << 8, 16, 65519), levels)]
    found = levels[np.abs(np.subtract.outer(*logits)).argmin(axis=1)]
    found[seen == 0] = 32768
    return b"".join(part.astype(np.uint8).tobytes() for part in (found & 255, found >> 8, seen)) + state[3 * count :]


def main() -> None:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    options.out.write_bytes(zlib.compress(compact(train(sorted(options.pictures.iterdir())).state()), 9))


if __name__ == "__main__":
    main()
