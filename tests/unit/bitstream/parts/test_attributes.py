"""Attributes read in one native call against the same step by step in Python, which is how they are written."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sgicodec.bitstream.entropy.symbol_coder import SymbolReader, SymbolWriter
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts import tile
from sgicodec.bitstream.parts.attributes import AttributeCoder
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import StreamError
from sgicodec.model.context import passes
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import default_plan
from sgicodec.profiles.default import default_spec

GOLDEN = Path(__file__).parents[3] / "conformance" / "golden"
STREAMS = [
    "rgb8-predicted-seeds",
    "rgb8-coarse-first",
    "rgb8-two-per-seed",
    "rgb8-own-context",
    "gray8-alpha",
    "multi8",
    "paper-rgb8",
]
every_stream = pytest.mark.parametrize("name", STREAMS)


def payload_of(name: str) -> tuple[Header, bytes]:
    with open_stream(GOLDEN / f"{name}.sgi") as stream:
        return stream.header, decode_tile_chunk(stream.header, stream.payload(0)).model or b""


@every_stream
@pytest.mark.parametrize("device", [ONE_THREAD, Device(2), Device(3, "portable")])
def test_both_ways_of_reading_agree(name: str, device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    header, payload = payload_of(name)
    model, walk = tile.read_tile(header, payload, device)
    with monkeypatch.context() as patch:
        patch.setattr(tile, "AttributeCoder", partial(AttributeCoder, matmul=np.matmul))
        other, steps = tile.read_tile(header, payload)
    np.testing.assert_array_equal(model.decoded, other.decoded)
    assert (walk.crc, walk.count) == (steps.crc, steps.count)
    assert walk.bits == pytest.approx(steps.bits, rel=1e-12)


def outcome(header: Header, payload: bytes) -> tuple[object, ...]:
    """What reading comes to, so that two ways can be compared."""
    try:
        model, walk = tile.read_tile(header, payload)
    except StreamError as error:
        return type(error), str(error)
    return walk.crc, model.decoded.tobytes() if model.decoded is not None else b""


@pytest.mark.parametrize("name", ["rgb8-predicted-seeds", "rgb8-two-per-seed"])
def test_damage_is_told_alike(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    header, payload = payload_of(name)
    rng = np.random.default_rng(0)
    found = set()
    for _ in range(60):
        changed = bytearray(payload[: rng.integers(1, len(payload))] if rng.random() < 0.3 else payload)
        changed[rng.integers(len(changed))] ^= 1 << int(rng.integers(8))
        damaged = bytes(changed).rstrip(b"\0")
        native = outcome(header, damaged)
        with monkeypatch.context() as patch:
            patch.setattr(tile, "AttributeCoder", partial(AttributeCoder, matmul=np.matmul))
            assert outcome(header, damaged) == native
        found.add(native[0])
    assert all(isinstance(kind, type) and issubclass(kind, StreamError) for kind in found)


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("spec", [default_spec(1), default_spec(3), default_spec(2, per_seed=2)])
def test_passes_of_many_runs(spec: ModelSpec, threads: int) -> None:
    """Thousands of seeds in a pass are worked on in several runs, and groups of one step are larger than the last's."""
    rng = np.random.default_rng(spec.channels)
    corner = 4 * np.stack(np.meshgrid(np.arange(90), np.arange(90)), axis=-1).reshape(-1, 2).astype(np.int32)
    layout = SeedLayout(corner, np.full(len(corner), 2, np.int8))
    layout = layout.take(layout.order())
    assert max(len(members) for members in passes(spec.context, layout)) > 3 * 512
    values = {group.name: rng.normal(0, 0.3, (len(layout), group.size)) for group in spec.groups}
    known: tuple[Any, ...] = spec, layout, (360, 360), default_plan(spec, 60), load_prior(spec), [], 60, 1
    writer = SymbolWriter()
    coder = AttributeCoder(*known)
    written = coder.code(writer, values)
    crc, bits = writer.crc, dict(writer.bits)
    reader = SymbolReader(writer.finish())
    read = replace(coder, device=Device(threads)).code(reader, None)
    np.testing.assert_array_equal(read, written)
    assert reader.crc == crc
    assert reader.bits == pytest.approx(bits)
    reader.finish()
