"""The restoration part comes back as it was written; unknown networks are refused."""

from __future__ import annotations

from dataclasses import replace

import pytest
from data_files import GOLDEN
from surgery import join, split

from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import read_tile, write_tile
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import UnsupportedStreamError
from sgicodec.model.restoration import Restoration
from sgicodec.rdoq.objective import with_values


def with_restoration(data: bytes, restoration: Restoration | None) -> bytes:
    """The stream of one tile, with another restoration."""
    with open_stream(data) as stream:
        header, model = stream.header, stream.model
    header = replace(header, spec=replace(header.spec, restoration=True))
    model = with_values(header.spec, model, model.decoded_values)
    payload, _ = write_tile(header, replace(model, decoded=None, restoration=restoration))
    return join([(kind, {"H": encode_header(header), "T": payload}.get(kind, part)) for kind, part in split(data)])


@pytest.mark.parametrize("name", ["rgb8-luma", "rgb8", "gray16-texture"])
@pytest.mark.parametrize("restoration", [None, Restoration(1, 0), Restoration(2, 511)])
def test_round_trip(name: str, restoration: Restoration | None) -> None:
    data = with_restoration((GOLDEN / f"{name}.sgi").read_bytes(), restoration)
    with open_stream(data) as stream:
        assert stream.header.spec.restoration
        assert stream.model.restoration == restoration
        header, payload = stream.header, stream.payload(0)
    _, read = read_tile(header, payload)
    assert read.bits["restoration"] == (4 if restoration is None else 13)


@pytest.mark.parametrize("network", [3, 4, 7, 9])
def test_unknown_networks_are_refused(network: int) -> None:
    data = with_restoration((GOLDEN / "rgb8-luma.sgi").read_bytes(), Restoration(network, 300))
    with (
        open_stream(data) as stream,
        pytest.raises(UnsupportedStreamError, match=f"restoration: network {network}; this"),
    ):
        stream.picture()
