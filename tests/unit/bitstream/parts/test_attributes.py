"""Attributes as they are written, and read by the library and as docs/format.md says."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from data_files import GOLDEN
from frequency_tables import SCALES
from page_tiles import read_from_the_page
from reference_decoder import ROUNDING
from surgery import split

from sgicodec._native import DEAD_ZONE_LIMIT
from sgicodec.bitstream.header import Header, decode_header
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.tile import TileModel, quantise, read_tile, write_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.device import Device
from sgicodec.model.context import nearest_by_pass
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan
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
    few = (model.layout.corner < 100).all(axis=1)
    attributes = {name: values[few] for name, values in (model.attributes or {}).items()}
    model = replace(model, layout=model.layout.take(few), attributes=attributes)
    read, page, _, _ = read_from_the_page(header, write_tile(header, model)[0])
    np.testing.assert_array_equal(read.decoded, quantise(header, model).decoded)
    first = {group.name: group.start for group in header.spec.groups}
    assert len(page.coded) == read.decoded.size >= 5000
    for group, seed, place, symbol, step, table in page.coded:
        value = attributes[group][seed, place]
        error = (read.decoded[seed, first[group] + place] - value * 2**24) / step  # in steps
        exact = symbol - error
        assert abs(error) <= 0.5 + DEAD_ZONE_LIMIT + 1e-6
        assert abs(symbol) <= abs(exact) + 0.5 + 1e-6
        assert symbol * exact >= 0
        if table % SCALES > 50:  # such a distribution charges nothing for a larger symbol
            assert abs(error) <= 0.5 + 2e-2


@pytest.mark.parametrize("name", ["gray16", "rgb8-tiles", "multi8", "paper-rgb8"])
def test_the_page_reads_the_same(name: str) -> None:
    header, payload = payload_of(name)
    read, page, reader, bits = read_from_the_page(header, payload)
    groups = {group.name for group in header.spec.groups}
    assert len(page.coded) == read.decoded.size
    assert bits == pytest.approx(sum(bits for part, bits in read.bits.items() if part in groups), rel=ROUNDING)
    if not header.spec.texture:
        reader.finish()
