"""Texture that claims more than it holds, in whole streams."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from little_memory import read_with_little_memory
from surgery import flipped, join, split
from texture_forger import spell

from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.parts import tile
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.texture import write_texture
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.errors import CorruptStreamError, StreamError
from sgicodec.model.layout import SeedLayout
from sgicodec.model.steps import default_plan
from sgicodec.profiles.default import default_spec

LEAF = "10" + "000001" + "10" + "0"  # a root of 32 pixels with a symbol 1


def forged(monkeypatch: pytest.MonkeyPatch, bits: str, width: int, height: int, channels: int) -> bytes:
    """A stream of a tile of nothing but texture that has these bits, then zeros."""
    spec = replace(default_spec(channels, texture=True), base_cell=0)
    header = Header(width, height, "multi", "uint8", (0.0, 255.0), "default", spec, 60, 1)
    nowhere = SeedLayout(np.zeros((0, 2), np.int32), np.zeros(0, np.int8))
    attributes = {group.name: np.zeros((0, group.size)) for group in spec.groups}
    base = np.zeros((channels, 0, 0), np.int64)
    model = TileModel(nowhere, default_plan(spec, 60), 0, base, {}, load_prior(spec), [], attributes)

    def code(coder: SymbolWriter, *_: Any) -> None:
        spell(coder, bits, (width, height), channels)

    with monkeypatch.context() as context:
        context.setattr(tile, "write_texture", code)
        payload, _ = tile.write_tile(header, model)
    return join([("H", encode_header(header)), ("T", payload), ("E", b"")])


def test_the_forger_can_write_a_sound_stream(monkeypatch: pytest.MonkeyPatch) -> None:
    with open_stream(forged(monkeypatch, LEAF, 40, 30, 1)) as stream:
        assert stream.survey().texture_cells == {8: 0, 16: 0, 32: 1}
        assert np.ptp(stream.render()) > 0


def test_texture_takes_no_more_memory_than_is_allowed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Beyond the cap nothing is read; below it a hundred bytes may claim it all."""
    side = 1 << 13
    sizes = {"beyond": (side, side + 1, 1), "wide": (1 << 20, 65, 1), "channels": (1056, 1024, 64)}
    for name, (width, height, channels) in sizes.items():
        (tmp_path / name).write_bytes(forged(monkeypatch, "1", width, height, channels))
    (tmp_path / "most").write_bytes(forged(monkeypatch, LEAF, side, side, 1))
    assert all(path.stat().st_size < 2000 for path in tmp_path.iterdir())
    results = read_with_little_memory(tmp_path)
    assert results.pop("most") == ("picture", "")
    assert set(results) == set(sizes)
    for kind, message in results.values():
        assert kind == "LimitError"
        assert "samples with texture" in message


@pytest.mark.parametrize("bits", ["0", "1" * 5000, "10000000", "110000", "10" + "000010" + "100" + "00"])
def test_texture_that_spells_nothing(monkeypatch: pytest.MonkeyPatch, bits: str) -> None:
    with (
        open_stream(forged(monkeypatch, bits, 32, 32, 1)) as stream,
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
def test_what_is_wrong_below_a_region_is_said(monkeypatch: pytest.MonkeyPatch, threads: int) -> None:
    """Rows are drawn while those below are read: a view ends only when all of them are."""
    bits = LEAF + "1" * 5000
    with open_stream(forged(monkeypatch, bits, 32, 4096, 1), Device(threads)) as stream:
        for _ in range(2):
            with pytest.raises(CorruptStreamError, match="texture"):
                stream.render((0, 0, 32, 8))
