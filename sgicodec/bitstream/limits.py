"""Limits of a tile, which a decoder checks before it spends memory or time (native/bitstream/limits.cpp), and shapes.

A writer asks whether a tile that it means to write would be refused.
"""

from __future__ import annotations

from dataclasses import replace

from sgicodec import _native
from sgicodec._native import check_texture
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.model.spec import ModelSpec

__all__ = ["check_model", "check_texture", "spec_fields"]


def check_model(spec: ModelSpec, width: int, height: int) -> None:
    """Raises LimitError if the products of the header's fields are beyond what a tile may hold."""
    _native.check_model(spec_fields(spec, width, height))


def spec_fields(spec: ModelSpec, width: int, height: int) -> bytes:
    """The header of a picture of so many pixels; of its samples nothing counts but how many channels they have."""
    plain = replace(spec, luma_space=False)
    return encode_header(Header(width, height, "multi", "uint8", (0.0, 255.0), "default", plain, 0, 0))
