"""Trains the adaptive models with which every texture layer begins, on the layers of many pictures.

    python -m tools.train_texture PICTURES_DIR OUT.bin

Each picture is encoded for squared error and for the eye, at several qualities. Layers are coded one after the other by
models that go on learning; since they remember the last layers best, this is done in many orders, and the mean is
taken, in sixteenths of a logit.
"""

from __future__ import annotations

import argparse
import random
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec._native import TextureModels
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.effort import Tune
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.picture import Picture

QUALITIES: dict[Tune, tuple[float, ...]] = {"psnr": (30, 42, 54, 66), "visual": (45, 57, 70, 83)}
EFFORTS: dict[Tune, int] = {"psnr": 2, "visual": 3}
ORDERS = 24
UNIT = 4096
"""Of a byte, in 2^-16 of a logit."""


def layers(picture: Picture) -> Iterator[TextureSymbols]:
    """The texture of a picture's streams."""
    for tune, qualities in QUALITIES.items():
        for quality in qualities:
            settings = EncodeSettings(quality=quality, effort=EFFORTS[tune], tune=tune, tile=0, overview=False)
            with open_stream(encode_picture(picture, settings).data) as stream:
                if stream.model.texture is not None:
                    yield stream.model.texture


def train(paths: list[Path]) -> bytes:
    """What the contexts say after all pictures, the mean of many orders, as `texture.bin` holds it."""
    everything = [layer for path in paths for layer in layers(read(path))]
    logits = []
    for order in range(ORDERS):
        random.Random(order).shuffle(everything)
        models = TextureModels()
        for layer in everything:
            models.learn(layer)
        logits.append(models.logits())
    sixteenths = np.rint(np.mean(logits, axis=0) / UNIT).clip(-127, 127)
    return bytes(sixteenths.astype(np.int8))


def main() -> None:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    options.out.write_bytes(zlib.compress(train(sorted(options.pictures.glob("*.png"))), 9))


if __name__ == "__main__":
    main()
