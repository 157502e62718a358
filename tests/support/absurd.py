"""Sound streams of models that no fit would find: every number as wild as the format lets it be."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from frequency_tables import MAX_MAGNITUDE
from page_header import SAMPLE_TYPES
from surgery import join
from textures import random_symbols

from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.parts.tile import TileModel, write_tile
from sgicodec.errors import CorruptStreamError
from sgicodec.model.base import base_shape
from sgicodec.model.context import hash_grid, network_shapes
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.quantization import STEP_COUNT
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, default_plan, follows_amplitude
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec


def absurd_stream(rng: np.random.Generator) -> bytes:
    """A stream that decodes, though what it decodes to is nonsense."""
    channels, per_seed = int(rng.choice([1, 2, 3, 4, 7])), int(rng.integers(1, 4))
    spec = default_spec(channels) if rng.random() < 0.5 else paper_spec(channels, per_seed, 5)
    spec = replace(spec, context=replace(spec.context, prior=0), texture=bool(rng.random() < 0.5))
    width, height = (int(2 ** rng.uniform(0, 9)) for _ in range(2))
    sample_type = str(rng.choice(SAMPLE_TYPES))
    reach = {"uint8": (0.0, 255.0), "uint16": (0.0, 65535.0), "float32": (-3e37, 2e37)}[sample_type]
    header = Header(width, height, "multi", sample_type, reach, "paper", spec, int(rng.integers(256)), 1)
    while True:
        try:
            payload, _ = write_tile(header, _model(header, rng))
        except CorruptStreamError:  # weights too large to be evaluated exactly, or a base layer out of bounds
            continue
        return join([("H", encode_header(header)), ("T", payload), ("E", b"")])


def _model(header: Header, rng: np.random.Generator) -> TileModel:
    spec, size = header.spec, (header.width, header.height)
    layout = _layout(header, rng)
    expected = default_plan(spec, header.colour_step)
    base = {name: rng.integers(0, STEP_COUNT, index.shape) for name, index in expected.base.items()}
    gamma = {name: int(rng.integers(64)) if follows_amplitude(spec, name) else 0 for name in expected.base}
    grid = (0, 0) if not spec.base_cell else base_shape(*size, spec.base_cell)
    return TileModel(
        layout,
        StepPlan(base, gamma),
        int(rng.integers(STEP_COUNT)) if spec.base_cell else 0,
        _wild(rng, (spec.channels, *grid), 100_000),
        {name: _wild(rng, shape, MAX_MAGNITUDE) for name, shape in decoder_shapes(spec).items()},
        tuple(_network(spec, step, rng) for step in range(len(spec.context.steps))),
        [rng.integers(0, 2, (n // 4, 4)) for n in hash_grid(spec.context, *size).counts],
        {group.name: _attributes(rng, (len(layout), group.size)) for group in spec.groups},
        texture=random_symbols(spec.channels, *size, int(rng.integers(2**32)), 16390) if spec.texture else None,
    )


def _layout(header: Header, rng: np.random.Generator) -> SeedLayout:
    log_size = np.zeros(40, int) if header.spec.layout == "uniform" else rng.integers(1, 7, 40)
    corner = rng.integers(0, (header.width, header.height), (40, 2)) >> log_size[:, None] << log_size[:, None]
    nodes = np.unique(np.concatenate([corner, log_size[:, None]], axis=1), axis=0)
    layout = SeedLayout(nodes[:, :2].astype(np.int32), nodes[:, 2].astype(np.int8))
    return layout.take(layout.order())


def _network(spec: ModelSpec, step: int, rng: np.random.Generator) -> IntNetwork:
    shapes = network_shapes(spec, step)
    weights = {name: _wild(rng, shape, 2 ** int(rng.integers(1, 20))) for name, shape in shapes.items()}
    names = spec.context.steps[step]
    return IntNetwork(**weights, shift=int(rng.integers(2, 21)), predicted=(shapes["b2"][0] - len(names)) // 2)


def _wild(rng: np.random.Generator, shape: tuple[int, ...], most: int) -> Any:
    """Integers up to ±most, of one random size throughout or each of its own."""
    bound = np.exp(rng.uniform(0, np.log(most), shape if rng.random() < 0.5 else ()))
    return np.rint(rng.uniform(-1, 1, shape) * bound).astype(np.int64)


def _attributes(rng: np.random.Generator, shape: tuple[int, ...]) -> Any:
    return rng.normal(size=shape) * np.exp(rng.uniform(-15, 15, shape if rng.random() < 0.5 else ()))
