"""What travels with a picture: blobs that are carried and never interpreted for the pixels' sake."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Metadata:
    r"""Opaque blobs that are carried, never interpreted for the pixels' sake.

    icc:  an ICC profile that fits the layout.
    exif: a TIFF structure (`II*\0` or `MM\0*` first, no `Exif\0\0` prefix) whose orientation, if any, is 1.
    xmp:  an XMP packet, UTF-8.
    geo:  where the picture lies and what its numbers mean: a little-endian TIFF structure with the tags of
          `sgicodec.metadata.geo` for the upright picture and its sample type.
    """

    icc: bytes | None = None
    exif: bytes | None = None
    xmp: bytes | None = None
    geo: bytes | None = None
