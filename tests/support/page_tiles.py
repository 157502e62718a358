"""Reads the attributes of a tile as docs/format.md says, with symbols of the native reader."""

from __future__ import annotations

import math

import numpy as np
from page_attributes import PageAttributes, Seed
from symbols import SymbolReader

from sgicodec import _native
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.device import ONE_THREAD
from sgicodec.model.base import base_shape
from sgicodec.model.context import hash_grid, network_shapes
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.steps import default_plan, follows_amplitude


def read_from_the_page(header: Header, payload: bytes) -> tuple[_native.TileModel, PageAttributes, SymbolReader, float]:
    """The tile as native code reads it, its attributes as the page does, which are the same; the reader behind them,
    and the bits that it found them to take.
    """
    read = _native.read_tile(encode_header(header), payload, 1, ONE_THREAD.isa)
    reader = SymbolReader(payload)
    skip_to_attributes(reader, header)
    seeds = [Seed(int(x), int(y), int(k)) for (x, y), k in zip(read.corner, read.log_size, strict=True)]
    plan = {name: (base, gamma) for name, base, gamma in read.plan}
    page = PageAttributes(header, seeds, plan, [network[:5] for network in read.networks], read.signs)
    before = reader.bits
    found = page.read_all(lambda tables: reader.read(np.array(tables, np.int16)).tolist())
    assert found == read.decoded.tolist()
    return read, page, reader, reader.bits - before


def skip_to_attributes(reader: SymbolReader, header: Header) -> None:
    """The parts before the attributes (docs/format.md, "Tile parts")."""
    spec = header.spec
    for name, index in default_plan(spec, header.colour_step).base.items():
        reader.read_weights(index.size)
        if follows_amplitude(spec, name):
            reader.read_bits(6, 1)
    if spec.base_cell:
        reader.read_bits(8, 1)
        reader.read_base(spec.channels, *base_shape(header.width, header.height, spec.base_cell))
    read = reader.read_tree if spec.layout == "adaptive" else reader.read_positions
    read((header.width, header.height), 10**5)
    if spec.hidden:
        reader.read_bits(5, 1)
    for weights in decoder_shapes(spec).values():
        reader.read_weights(math.prod(weights))
    if counts := hash_grid(spec.context, header.width, header.height).counts:
        reader.read_signs(counts)
    for step in range(len(spec.context.steps) if not spec.context.prior else 0):
        reader.read_bits(5, 1)
        for weights in network_shapes(spec, step).values():
            reader.read_weights(math.prod(weights))
