"""Damaged and forged tiles end alike on every device: with the same model, or the same error."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import GOLDEN_STREAMS
from mutate import mutated
from surgery import split

from sgicodec import _native
from sgicodec.device import Device
from sgicodec.errors import SgiError

DEVICES = [Device(1), Device(3, "portable")]


def outcome(header: bytes, payload: bytes, device: Device, checked: bool) -> tuple[object, ...]:
    """What the tile holds, or the error."""
    try:
        _, _, masks, exact, model = _native.decode_tile_chunk(header, payload)
        read = _native.read_tile(header, model, device.threads, device.isa, checked)
    except SgiError as error:
        return type(error).__name__, str(error)
    texture = None if read.texture is None else [array.tobytes() for array in read.texture[1:]]
    arrays = [array.tobytes() for array in (read.corner, read.log_size, read.decoded, read.base, read.signs)]
    sizes = [(is_all, None if tree is None else tree.nbytes) for is_all, tree in masks]
    return read.crc, arrays, read.base_step, read.bits, texture, sizes, repr(exact)


@pytest.mark.parametrize("seed", range(4))
def test_every_device_ends_alike(seed: int) -> None:
    """With the checksum of symbols compared, and without: what a forger could make fit."""
    streams, rng = [path.read_bytes() for path in GOLDEN_STREAMS], np.random.default_rng(seed)
    ends = set()
    for _ in range(80):
        data = mutated(streams[int(rng.integers(len(streams)))], streams, rng)
        try:
            (_, header), *parts = split(data)
        except (SgiError, IndexError, ValueError):  # no chunks are left
            continue
        for payload in (payload for letter, payload in parts if letter == "T"):
            for checked in (True, False):
                first, *others = (outcome(header, payload, device, checked) for device in DEVICES)
                assert others == [first]
                ends.add(first[0])
    assert {"CorruptStreamError", "LimitError"} < ends
