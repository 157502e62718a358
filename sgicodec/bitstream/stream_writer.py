"""The stream writer: chunks in their order."""

from __future__ import annotations

from collections.abc import Iterable
from typing import BinaryIO

from sgicodec.bitstream.chunks import METADATA
from sgicodec.bitstream.container import ChunkWriter
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.index import Place, encode_index
from sgicodec.picture import Metadata


def write_stream(
    file: BinaryIO,
    header: Header,
    software: bytes,
    metadata: Metadata | None,
    tiles: Iterable[bytes],
    overview: bytes | None = None,
    residual: bytes | None = None,
) -> int:
    """Writes a stream whose tiles have these payloads, in the order of their numbers; returns its length.

    overview: a stream of its own; residual: the payload of a residual layer. A stream of several tiles ends with an
    index.
    """
    writer = ChunkWriter(file)
    writer.write("H", encode_header(header))
    writer.write("s", software)
    for field, letter in METADATA.items():
        if blob := getattr(metadata, field, None):
            writer.write(letter, blob)
    if overview:
        writer.write("o", overview)
    if residual:
        writer.write("r", residual)
    places = []
    for payload in tiles:
        places.append(Place(writer.offset, len(payload)))
        writer.write("T", payload)
    if header.tile:
        writer.write("X", encode_index(places, writer.offset))
    writer.finish()
    return writer.offset
