"""Attributes as they are written, and read by the library and as docs/format.md says."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from data_files import GOLDEN
from frequency_tables import SCALES
from page_attributes import PageAttributes, Seed
from reference_decoder import ROUNDING
from surgery import split
from symbols import SymbolReader

from sgicodec import _native
from sgicodec.bitstream.header import Header, decode_header, encode_header
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.tile import TileModel, quantise, read_tile, write_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.device import ONE_THREAD, Device
from sgicodec.model.base import base_shape
from sgicodec.model.context import hash_grid, nearest_by_pass, network_shapes
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import SeedLayout
from sgicodec.model.quantization import DEAD_ZONE_LIMIT
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan, follows_amplitude
from sgicodec.profiles.default import default_spec


@cache
def payload_of(name: str) -> tuple[Header, bytes]:
    parts = split((GOLDEN / f"{name}.sgi").read_bytes())
    header = decode_header(parts[0][1])
    chunk = decode_tile_chunk(header, dict(parts)["T"])
    return header.of_tile(chunk.number), chunk.model or b""


def of_many_seeds(spec: ModelSpec) -> tuple[Header, TileModel]:
    """Random values of thousands of seeds in a pass."""
    spec = replace(spec, base_cell=0)
    rng = np.random.default_rng(spec.channels)
    corner = 4 * np.stack(np.meshgrid(np.arange(90), np.arange(90)), axis=-1).reshape(-1, 2).astype(np.int32)
    layout = SeedLayout(corner, np.full(len(corner), 2, np.int8))
    layout = layout.take(layout.order())
    assert max(len(members) for members, _ in nearest_by_pass(spec.context, layout)) > 3 * 512
    values = {group.name: rng.normal(0, 0.3, (len(layout), group.size)) for group in spec.groups}
    header = Header(360, 360, "multi", "uint8", (0.0, 255.0), "default", spec, 60, 1)
    nothing = np.zeros((spec.channels, 0, 0), np.int64)
    return header, TileModel(layout, default_plan(spec, 60), 0, nothing, {}, load_prior(spec), [], values)


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("spec", [default_spec(1), default_spec(3), default_spec(2)])
def test_passes_of_many_runs(spec: ModelSpec, threads: int) -> None:
    """Seeds of a pass are worked on in several runs, and groups of one step are larger than the last's."""
    header, model = of_many_seeds(spec)
    payload, written = write_tile(header, model)
    read, reader = read_tile(header, payload, Device(threads))
    np.testing.assert_array_equal(read.decoded, quantise(header, model).decoded)
    assert reader.bits == written


def test_decisions_lean_towards_zero_and_stay_near() -> None:
    header, model = of_many_seeds(default_spec(3))
    spec, quantised = header.spec, quantise(header, model)
    runs = iter(quantised.runs)
    for members, _ in nearest_by_pass(spec.context, model.layout):
        for group in spec.groups:
            run, values = next(runs), (model.attributes or {})[group.name][members]
            assert run.group == group.name
            error = (quantised.values[members][:, group.columns] - values) / (run.steps / 2**24)  # in steps
            exact = run.symbols - error
            assert np.all(np.abs(error) <= 0.5 + DEAD_ZONE_LIMIT + 1e-6)
            assert np.all(np.abs(run.symbols) <= np.abs(exact) + 0.5 + 1e-6)
            assert np.all(run.symbols * exact >= 0)
            wide = run.tables % SCALES > 50  # such a distribution charges nothing for a larger symbol
            assert np.all(np.abs(error[wide]) <= 0.5 + 2e-2)
    assert next(runs, None) is None


@pytest.mark.parametrize("name", ["gray16", "rgb8-tiles", "multi8", "paper-rgb8"])
def test_the_page_reads_the_same(name: str) -> None:
    """With symbols of the native reader, which comes to the attributes by reading what lies before them."""
    header, payload = payload_of(name)
    read = _native.read_tile(encode_header(header), payload, 1, ONE_THREAD.isa)
    reader, groups = SymbolReader(payload), {group.name for group in header.spec.groups}
    skip_to_attributes(reader, header)
    seeds = [Seed(int(x), int(y), int(k)) for (x, y), k in zip(read.corner, read.log_size, strict=True)]
    plan = {name: (base, gamma) for name, base, gamma in read.plan}
    page = PageAttributes(header, seeds, plan, [network[:5] for network in read.networks], read.signs)
    before = reader.bits
    found = page.read_all(lambda tables: reader.read(np.array(tables, np.int16)).tolist())
    assert found == read.decoded.tolist()
    assert reader.bits - before == pytest.approx(
        sum(bits for part, bits in read.bits.items() if part in groups), rel=ROUNDING
    )
    if not header.spec.texture:
        reader.finish()


def skip_to_attributes(reader: SymbolReader, header: Header) -> None:
    """The parts before the attributes (docs/format.md, "Tile parts")."""
    spec = header.spec
    for name, index in default_plan(spec, header.quality).base.items():
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
