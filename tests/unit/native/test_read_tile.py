"""The native reader of tiles gives what the reader in Python gives: models, checksums, errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mutate import mutated
from surgery import split

from sgicodec import _native
from sgicodec._native import NEIGHBOUR_INPUTS
from sgicodec.bitstream.entropy.symbol_coder import SymbolReader
from sgicodec.bitstream.header import Header, decode_header, encode_header
from sgicodec.bitstream.parts.tile import read_tile, write_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.device import Device
from sgicodec.errors import SgiError
from sgicodec.model.context import input_count

GOLDEN = sorted((Path(__file__).parents[2] / "conformance" / "golden").glob("*.sgi"))
DEVICE = Device(1)


def by_python(header: Header, payload: bytes) -> tuple[Any, ...]:
    """All that a payload says."""
    model, reader = read_tile(header, payload)
    assert model.decoded is not None
    signs = np.concatenate([np.zeros(0), *(table.reshape(-1) for table in model.hash_tables)])
    texture: tuple[Any, ...] = ()
    if model.texture is not None:
        of, steps = model.texture, model.texture.steps
        indices = steps.step, *steps.ratios, *steps.slopes, *steps.excess, steps.has_contrast, steps.dependent
        texture = indices, of.log_size, of.contrast, of.symbols
    coding = [(name, model.plan.base[name], model.plan.gamma[name]) for name in model.plan.base]
    networks = [(*network.arrays, network.shift, network.predicted) for network in model.networks]
    seeds = model.layout.corner, model.layout.log_size, model.decoded, model.base, model.base_step
    bits = {name: bits for name, bits in reader.bits.items() if bits and name != "check"}
    return reader.crc, *seeds, sorted(model.decoders.items()), signs, coding, networks, texture, bits


def by_native(header: Header, payload: bytes, threads: int = 1, checked: bool = True) -> tuple[Any, ...]:
    """The same."""
    model = _native.read_tile(encode_header(header), payload, threads, DEVICE.isa, checked)
    texture: tuple[Any, ...] = ()
    if model.texture is not None:
        (step, ratios, slopes, excess, has_contrast, dependent), *arrays = model.texture
        texture = (step, *ratios, *slopes, *excess, has_contrast, dependent), *arrays
    coding = [(name, base, gamma) for name, (base, gamma) in model.plan.items()]
    seeds = model.corner, model.log_size, model.decoded, model.base, model.base_step
    bits = {name: bits for name, bits in model.part_bits.items() if name != "check"}
    decoders = sorted(model.decoders.items())
    return model.symbol_crc, *seeds, decoders, model.signs, coding, model.networks, texture, bits


def outcome(read: Callable[[], Any]) -> Any:
    """What was read, or the error."""
    try:
        return read()
    except SgiError as error:
        return type(error).__name__, str(error)


def require_equal(found: Any, expected: Any) -> None:
    """Arrays by type, shape and numbers, information content nearly."""
    if isinstance(expected, dict):
        assert found == pytest.approx(expected)
    elif isinstance(expected, list | tuple):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            require_equal(one, other)
    elif isinstance(expected, np.ndarray):
        np.testing.assert_array_equal(found, expected)
    else:
        assert found == expected


def chunks(data: bytes) -> list[bytes]:
    """Payloads of the tiles of a stream."""
    return [payload for letter, payload in split(data) if letter == "T"]


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden_tiles_are_read_alike(path: Path) -> None:
    data = path.read_bytes()
    header = decode_header(split(data)[0][1])
    for payload in chunks(data):
        chunk = decode_tile_chunk(header, payload)
        number, is_empty, mask, model = _native.decode_tile_chunk(encode_header(header), payload)
        assert (number, None if is_empty else model) == (chunk.number, chunk.model)
        if chunk.model is None:
            continue
        if mask is not None and chunk.mask is not None:
            rows, columns = np.arange(chunk.mask.height), np.arange(chunk.mask.width)
            np.testing.assert_array_equal(mask.at(rows, columns), chunk.mask.pixels())
            np.testing.assert_array_equal(mask.at(rows[3::5], columns[1::7]), chunk.mask.at(rows[3::5], columns[1::7]))
            assert mask.nbytes == chunk.mask.nbytes
        own = header.of_tile(number)
        expected = by_python(own, chunk.model)
        for threads in (1, 2):
            require_equal(by_native(own, model, threads), expected)


def test_seeds_without_neighbours_see_their_own_shape() -> None:
    """In the third step: a model that has steps but no neighbours, written by one program and read by the other."""
    path = next(path for path in GOLDEN if path.stem == "rgb8-own-context")
    header = decode_header(split(path.read_bytes())[0][1])
    (payload,) = chunks(path.read_bytes())
    model, _ = read_tile(header, payload)
    seen = [*range(kept := input_count(header.spec, 0) - NEIGHBOUR_INPUTS), *range(kept + NEIGHBOUR_INPUTS, 99)]
    context = replace(header.spec.context, neighbours=0, coarse_first=False)
    alone = replace(header, spec=replace(header.spec, context=context))
    networks = tuple(replace(net, w1=net.w1[:, [i for i in seen if i < net.w1.shape[1]]]) for net in model.networks)
    attributes = {group.name: model.decoded_values[:, group.columns] for group in header.spec.groups}
    model = replace(model, networks=networks, attributes=attributes, decoded=None)
    payload, writer = write_tile(alone, model)
    found = _native.read_tile(encode_header(alone), payload, 1, DEVICE.isa)
    assert found.symbol_crc == writer.crc
    np.testing.assert_array_equal(found.decoded, model.decoded)


@pytest.mark.parametrize("seed", range(4))
def test_damaged_tiles_are_read_alike(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the checksum of symbols compared, and without: what a forger could make fit."""
    streams, rng = [path.read_bytes() for path in GOLDEN], np.random.default_rng(seed)
    read = 0
    while read < 60:
        data = mutated(streams[int(rng.integers(len(streams)))], streams, rng)
        header = outcome(lambda data=data: decode_header(split(data)[0][1]))
        if not isinstance(header, Header):
            continue
        for payload in chunks(data):
            read += 1
            chunk = outcome(lambda header=header, payload=payload: decode_tile_chunk(header, payload))
            fields = encode_header(header)
            found = outcome(lambda fields=fields, payload=payload: _native.decode_tile_chunk(fields, payload))
            if found[0] != getattr(chunk, "number", None):
                assert found == chunk
                continue
            own, model = header.of_tile(found[0]), found[3]
            if found[1]:
                assert chunk.model is None
                continue
            for checked in (True, False):
                with monkeypatch.context() as patch:
                    if not checked:
                        patch.setattr(SymbolReader, "finish", lambda reader: None)
                    expected = outcome(lambda own=own, model=model: by_python(own, model))
                found = outcome(lambda own=own, model=model, checked=checked: by_native(own, model, 1, checked))
                require_equal(found, expected)
