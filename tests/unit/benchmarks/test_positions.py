"""What places cost, of a golden stream."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.positions import costs, main
from sgicodec.bitstream.parts.tile import read_tile
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.decoder.stream import open_stream

STREAM = Path(__file__).parents[2] / "conformance" / "golden" / "rgb8-predicted-seeds.sgi"


def test_bits_are_those_of_the_stream() -> None:
    with open_stream(STREAM) as stream:
        _, walk = read_tile(stream.header, decode_tile_chunk(stream.header, stream.payload(0)).model or b"")
        seeds = len(stream.model.layout)
    count, stated, predicted = costs(STREAM, repeat=1)
    assert count == seeds
    assert predicted.bits == pytest.approx(walk.bits["positions"], abs=1e-6)
    assert stated.bits != predicted.bits


def test_a_line_for_each_stream(capsys: pytest.CaptureFixture[str]) -> None:
    main([str(STREAM)] * 2)
    assert capsys.readouterr().out.count("| rgb8-predicted-seeds |") == 2
