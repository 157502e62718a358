"""Models to refine: fitted to nothing, so that there is much to improve."""

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.device import Device
from sgicodec.model.base import base_shape
from sgicodec.model.layout import adaptive_layout
from sgicodec.model.steps import default_plan
from sgicodec.profiles.default import default_spec
from sgicodec.rdoq import Objective

QUALITY = 55
LAYOUTS = {1: "gray", 3: "rgb", 4: "rgba"}


def waves(channels: int, height: int, width: int) -> NDArray[np.float32]:
    """A picture [C, H, W] of a few waves, around zero."""
    rng = np.random.default_rng(channels)
    y, x = np.mgrid[:height, :width]
    picture = np.zeros((channels, height, width))
    for _ in range(6):
        across, down, phase = rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(0, 6)
        picture += 0.06 * rng.normal(size=(channels, 1, 1)) * np.sin(across * x + down * y + phase)
    return picture.astype(np.float32)


def stage(
    channels: int = 3,
    height: int = 70,
    width: int = 100,
    isa: str = "auto",
    threads: int = 2,
    weighted: bool = False,
) -> tuple[Objective, TileModel]:
    """A picture and a model of seeds with random attributes."""
    spec, rng = default_spec(channels), np.random.default_rng(7)
    picture = waves(channels, height, width)
    header = Header(
        width, height, LAYOUTS[channels], "uint8", (0.0, 255.0), "default", spec, colour_step=QUALITY, family=1
    )
    layout = adaptive_layout(picture, 0.4)
    n = len(layout)
    attributes = {
        "colour": rng.normal(0, 0.05, (n, channels)),
        "shape": rng.normal([-0.6, 0, 0], 0.3, (n, 3)),
        "offset": rng.normal(0, 0.2, (n, 2)),
    }
    base = np.zeros((channels, *base_shape(width, height, spec.base_cell)), np.int64)
    model = TileModel(layout, default_plan(spec, QUALITY), 60, base, {}, load_prior(spec), [], attributes)
    weights = np.asarray(rng.uniform(0.2, 3.0, (height, width)), np.float32) if weighted else None
    return Objective(header, picture, Device(threads, isa), weights), model
