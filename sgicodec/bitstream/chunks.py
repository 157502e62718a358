"""The kinds of chunks of a stream, from the table of native code (native/bitstream/chunk_kinds.hpp)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from sgicodec import _native
from sgicodec.metadata.blobs import Metadata


class ChunkKind(NamedTuple):
    """letter: its type in the file. name: for people. is_once: whether a stream has at most one. metadata: which field
    of `Metadata` travels in it, None for none.
    """

    letter: str
    name: str
    is_once: bool
    metadata: str | None


CHUNKS = tuple(ChunkKind(*kind) for kind in _native.CHUNK_KINDS)
"""All kinds, in the order in which they are written."""

METADATA = {kind.metadata: kind.letter for kind in CHUNKS if kind.metadata is not None}
"""Letters of the chunks of metadata, by the field."""


def metadata_of(blobs: Mapping[str, bytes]) -> Metadata:
    """What travels with a picture, from the payloads of a stream's chunks by letter."""
    return Metadata(**{field: blobs.get(letter) for field, letter in METADATA.items()})
