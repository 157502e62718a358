"""Texture that claims more than it holds, in whole streams."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from little_memory import read_with_little_memory
from surgery import flipped, join, split
from symbols import SymbolWriter, write_texture, write_tree, write_weights
from texture_forger import spell

from sgicodec.bitstream.header import Header, encode_header
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.errors import CorruptStreamError, StreamError
from sgicodec.model.steps import default_plan, follows_amplitude
from sgicodec.profiles.default import default_spec

LEAF = "10" + "000001" + "10" + "0"  # a root of 32 pixels with a symbol 1


def forged(bits: str, width: int, height: int, channels: int) -> bytes:
    """A stream of a tile of nothing but texture that has these bits, then zeros."""
    spec = replace(default_spec(channels, texture=True), base_cell=0, restoration=False)
    header = Header(width, height, "multi", "uint8", (0.0, 255.0), "default", spec, 60, 1)
    walk = SymbolWriter()
    for name, index in default_plan(spec, 60).base.items():
        write_weights(walk, np.zeros_like(index))
        if follows_amplitude(spec, name):
            walk.code_int(0, 6)
    write_tree(walk, (width, height), (np.zeros((0, 2), np.int32), np.zeros(0, np.int8)))
    spell(walk, bits, (width, height), channels)
    return join([("H", encode_header(header)), ("T", walk.finish()), ("E", b"")])


def test_the_forger_can_write_a_sound_stream() -> None:
    with open_stream(forged(LEAF, 40, 30, 1)) as stream:
        assert stream.survey().texture_cells == {8: 0, 16: 0, 32: 1}
        assert np.ptp(stream.render()) > 0


def test_texture_takes_no_more_memory_than_is_allowed(tmp_path: Path) -> None:
    """Beyond the cap nothing is read; below it a hundred bytes may claim it all."""
    side = 1 << 13
    sizes = {"beyond": (side, side + 1, 1), "wide": (1 << 20, 65, 1), "channels": (1056, 1024, 64)}
    for name, (width, height, channels) in sizes.items():
        (tmp_path / name).write_bytes(forged("1", width, height, channels))
    (tmp_path / "most").write_bytes(forged(LEAF, side, side, 1))
    assert all(path.stat().st_size < 2000 for path in tmp_path.iterdir())
    results = read_with_little_memory(tmp_path)
    assert results.pop("most") == ("picture", "")
    assert set(results) == set(sizes)
    for kind, message in results.values():
        assert kind == "LimitError"
        assert "samples with texture" in message


@pytest.mark.parametrize("bits", ["0", "1" * 5000, "10000000", "110000", "10" + "000010" + "100" + "00"])
def test_texture_that_spells_nothing(bits: str) -> None:
    with (
        open_stream(forged(bits, 32, 32, 1)) as stream,
        pytest.raises(CorruptStreamError, match="texture"),
    ):
        stream.picture()


def test_changed_bits_of_texture_are_found(coded: Any) -> None:
    """With fitting checksums of the chunk: the check of symbols must tell."""
    with open_stream(coded.data) as stream:
        if not stream.header.spec.texture:
            return
        texture = stream.model.texture
        assert texture is not None
    writer = SymbolWriter()
    write_texture(writer, texture.size, 3, texture)
    parts = split(coded.data)
    payload = parts[3][1]
    first = len(payload) - len(writer.finish())
    assert first < 0.8 * len(payload)
    for bit in range(8 * first, 8 * len(payload) - 40, 11):  # the last word may say the same in other words
        changed = join([*parts[:3], ("T", flipped(payload, bit)), parts[4]])
        with pytest.raises(StreamError):
            open_stream(changed).picture()


@pytest.mark.parametrize("threads", [1, 2])
def test_what_is_wrong_below_a_region_is_said(threads: int) -> None:
    """Rows are drawn while those below are read: a view ends only when all of them are."""
    bits = LEAF + "1" * 5000
    with open_stream(forged(bits, 32, 4096, 1), Device(threads)) as stream:
        for _ in range(2):
            with pytest.raises(CorruptStreamError, match="texture"):
                stream.render((0, 0, 32, 8))
