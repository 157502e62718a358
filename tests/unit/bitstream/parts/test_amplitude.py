"""The amplitude index of a seed against docs/format.md, in Python's integers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from integer_root import root
from page_tiles import read_from_the_page

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel, write_tile
from sgicodec.model.context import network_shapes
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.quantization import STEP_COUNT, STEP_ZERO, step_index
from sgicodec.model.steps import StepPlan, default_plan
from sgicodec.profiles.default import default_spec

CHANNELS = 32
_SPEC = default_spec(CHANNELS)
SPEC = replace(_SPEC, luma_space=False, base_cell=0, context=replace(_SPEC.context, prior=0))


def shape_steps(colours: list[list[int]], base: int) -> np.ndarray:
    """Indices of the steps of seeds' shapes: `base` less the amplitude index and 20, where nothing is predicted. The
    colours are integers in units of 2^-12.
    """
    shapes = [network_shapes(SPEC, step) for step in range(3)]
    networks = tuple(
        IntNetwork(**{name: np.zeros(shape, np.int64) for name, shape in step.items()}, shift=8, predicted=count)
        for step, count in zip(shapes, (3, 3, 2), strict=True)
    )
    plan = default_plan(SPEC, 0)
    bases = {name: np.full_like(b, STEP_ZERO - 72 if name == "colour" else base) for name, b in plan.base.items()}
    n = len(colours)
    corner = np.stack([2 * np.arange(n), np.zeros(n)], axis=1).astype(np.int32)
    layout = SeedLayout(corner, np.ones(n, np.int8))
    header = Header(2 * n, 2, "multi", "uint8", (0.0, 255.0), "default", SPEC, 0, 0)
    values = {"colour": np.array(colours) / 2.0**12, "shape": np.full((n, 3), 5.0), "offset": np.zeros((n, 2))}
    nothing = np.zeros((CHANNELS, 0, 0), np.int64)
    model = TileModel(layout, StepPlan(bases, plan.gamma), 0, nothing, {}, networks, [], values)
    read, page, _, _ = read_from_the_page(header, write_tile(header, model)[0])
    assert np.array_equal(read.decoded[:, :CHANNELS], np.array(colours) << 12)
    symbols = {one.seed: one.symbol for one in page.coded if (one.group, one.place) == ("shape", 0)}
    steps = np.array([read.decoded[seed, CHANNELS] // symbols[seed] for seed in range(n)])
    return step_index(steps * 2.0**-24)


@pytest.mark.parametrize("offset", [-1, 0, 1, 2])
def test_amplitude_index_at_every_boundary(offset: int) -> None:
    """Energies on both sides of 2^(third / 3), as sums of squares."""
    energies = [max(1, root(2**third, 3) + offset) for third in range(127)]
    colours = []
    for energy in energies:
        parts, rest = [], energy
        while rest:
            parts.append(min(math.isqrt(rest), 2**20))
            rest -= parts[-1] ** 2
        colours.append(parts + [0] * (CHANNELS - len(parts)))
    low, high = shape_steps(colours, 0), shape_steps(colours, STEP_COUNT - 1)
    found = np.where(low > 0, -low, STEP_COUNT - 1 - high) - 20
    assert found.tolist() == [(energy**3).bit_length() - 73 for energy in energies]
