"""The restoration part comes back as it was written, and so does a network of the picture; others are refused."""

from __future__ import annotations

from dataclasses import replace

import pytest
from data_files import GOLDEN
from restoration_reader import another_network
from surgery import join, split

from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import read_tile, write_tile
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError
from sgicodec.model.restoration import Restoration
from sgicodec.rdoq.objective import with_values

OWN = another_network()


def with_restoration(data: bytes, restoration: Restoration | None, network: bytes = b"") -> bytes:
    """The stream of one tile, with another restoration and a network in its header."""
    with open_stream(data) as stream:
        header, model = stream.header, stream.model
    header = replace(header, spec=replace(header.spec, restoration=True), network=network)
    model = with_values(header.spec, model, model.decoded_values)
    payload, _ = write_tile(header, replace(model, decoded=None, restoration=restoration))
    return join([(kind, {"H": encode_header(header), "T": payload}.get(kind, part)) for kind, part in split(data)])


@pytest.mark.parametrize("name", ["rgb8-luma", "rgb8", "gray16-texture"])
@pytest.mark.parametrize(
    ("restoration", "network"),
    [(None, b""), (Restoration(1, 0), b""), (Restoration(2, 511), b""), (Restoration(OWN, 300), OWN), (None, OWN)],
)
def test_round_trip(name: str, restoration: Restoration | None, network: bytes) -> None:
    data = with_restoration((GOLDEN / f"{name}.sgi").read_bytes(), restoration, network)
    with open_stream(data) as stream:
        assert stream.header.spec.restoration
        assert stream.header.network == network
        assert stream.model.restoration == restoration
        header, payload = stream.header, stream.payload(0)
    _, read = read_tile(header, payload)
    assert read.bits["restoration"] == (4 if restoration is None else 13)


@pytest.mark.parametrize(
    ("network", "error", "says"),
    [
        *((number, UnsupportedStreamError, f"restoration: network {number}; this") for number in (3, 4, 7, 9)),
        (OWN, CorruptStreamError, "of its own that the picture does not"),
    ],
)
def test_unknown_networks_are_refused(network: int | bytes, error: type[Exception], says: str) -> None:
    data = with_restoration((GOLDEN / "rgb8-luma.sgi").read_bytes(), Restoration(network, 300))
    with open_stream(data) as stream, pytest.raises(error, match=says):
        stream.picture()


@pytest.mark.parametrize(
    ("network", "error"),
    [
        (OWN[:-1], CorruptStreamError),
        (OWN + b"0", CorruptStreamError),
        (b"\7" + OWN[1:], CorruptStreamError),  # layers
        (OWN[:3] + b"\x3d" + OWN[4:], CorruptStreamError),  # channels
        (bytes([2, 0, 3, 64, 0, 64, 3, 0]) + b"\x7f" * (2 * 27 * 64 + 2 * 67), CorruptStreamError),  # sums beyond 2³¹
        (OWN + bytes(1 << 14), LimitError),
    ],
)
def test_files_that_are_no_networks_are_refused(network: bytes, error: type[Exception]) -> None:
    data = with_restoration((GOLDEN / "rgb8-luma.sgi").read_bytes(), None)
    with open_stream(data) as stream:
        header = encode_header(replace(stream.header, network=network))
    with pytest.raises(error, match="network of restoration"):
        open_stream(join([(kind, header if kind == "H" else part) for kind, part in split(data)]))
