"""Streams of every kind decode to the same symbols on every machine; to the same samples: test_suite.py.

`manifest.json` lists what each stream decodes to. `add_golden.py` adds new ones; none is ever made anew.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import pytest
from scenes import ISAS
from surgery import split

from sgicodec.bitstream.parts.tile import read_tile, write_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device

HERE = Path(__file__).parent
MANIFEST = json.loads((HERE / "manifest.json").read_text())


def test_no_stream_is_missing() -> None:
    assert {path.stem for path in HERE.glob("*.sgi")} == set(MANIFEST)


@pytest.mark.parametrize("name", sorted(MANIFEST))
def test_no_stream_has_changed(name: str) -> None:
    assert hashlib.sha256((HERE / f"{name}.sgi").read_bytes()).hexdigest() == MANIFEST[name]["sha256"]


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize("name", sorted(MANIFEST))
def test_symbols(name: str, isa: str) -> None:
    expected = MANIFEST[name]
    with open_stream(HERE / f"{name}.sgi", Device(isa=isa)) as stream:
        header = stream.header
        assert (header.width, header.height, header.channels) == tuple(expected["picture"])
        assert header.sample_type == expected["sample_type"]
        assert stream.survey().seeds == expected["seeds"]
        assert f"{stream.symbol_crc:08x}" == expected["symbol_crc"]
        assert {str(side): n for side, n in stream.survey().texture_cells.items()} == expected.get("texture_cells", {})
        if "overview_crc" in expected:
            assert f"{stream.overview.symbol_crc:08x}" == expected["overview_crc"]


@pytest.mark.parametrize("name", sorted(MANIFEST))
def test_what_is_read_is_written_again(name: str) -> None:
    """Byte by byte: today's writer still says the same of the same model."""
    data = (HERE / f"{name}.sgi").read_bytes()
    header = open_stream(data).header
    for chunk in (decode_tile_chunk(header, payload) for letter, payload in split(data) if letter == "T"):
        own = header.of_tile(chunk.number)
        if chunk.model is None:  # a tile without content
            continue
        model, _ = read_tile(own, chunk.model)
        attributes = {group.name: model.decoded_values[:, group.columns] for group in own.spec.groups}
        assert write_tile(own, replace(model, attributes=attributes, decoded=None))[0] == chunk.model
