"""EXIF, XMP and `geo` inside picture files, kept byte for byte.

OpenImageIO turns EXIF and XMP into attributes of its own and back, and on the way loses maker notes, many GPS fields
and any XMP that it does not know; of GeoTIFF it knows nothing. A little container syntax keeps them whole.
"""

from __future__ import annotations

import os
import struct
from pathlib import Path

from sgicodec.errors import PictureError
from sgicodec.metadata import bmp, exif, jpeg, png, tiff, webp
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.filebytes import Bytes, FileBytes

__all__ = ["copies", "embed", "extract", "orientation_in_xmp"]

_INSERT = {"bmp": bmp.insert, "jpeg": jpeg.insert, "webp": webp.insert}
_REWRITTEN = ("bmp", "jpeg")
"""Formats whose files are rewritten even without metadata: to declare alpha, to lose what OpenImageIO puts there."""


def extract(data: Bytes) -> Metadata:
    """EXIF and XMP, both with the orientation set to 1, and `geo`, which still speaks of the stored pixels, in the
    bytes of any picture file; each None where there is none.
    """
    blob, xmp, place = _find(data)
    return Metadata(exif=blob and exif.upright(blob), xmp=xmp and exif.upright_xmp(xmp), geo=place)


def orientation_in_xmp(data: Bytes) -> int | None:
    """The orientation that the XMP packet states, 1 to 8, or None."""
    return exif.xmp_orientation(_find(data)[1] or b"")


def _find(data: Bytes) -> tuple[bytes | None, bytes | None, bytes | None]:
    """EXIF, XMP and `geo` as they stand in the file."""
    if data[:3] == jpeg.SIGNATURE:
        return *jpeg.find(data), None
    if data[:8] == png.SIGNATURE:
        return *png.find(data), None
    return (*webp.find(data), None) if webp.is_webp(data) else tiff.find(data)


def copies(holder: str) -> int:
    """How many times a file in the format `holder` may stand on the disk while `embed` works on it."""
    return 1 if holder == "tiff" or holder not in _INSERT else 2


def embed(path: Path, holder: str, metadata: Metadata, bands: int | None = None) -> None:
    """Put EXIF, XMP and `geo` into the file that was just written at `path` in the format `holder`, as far as it has
    a place for them and its writer, that of PNG, has not put them there. bands: as for `tiff.insert`.

    Raises PictureError if they do not fit.
    """
    blob, xmp = metadata.exif, metadata.xmp
    if holder == "tiff":
        try:
            tiff.insert(path, blob, xmp, metadata.geo, bands)
        except struct.error as error:
            raise PictureError(f"tiff cannot hold its metadata: {error}") from error
    elif holder in _REWRITTEN or (holder in _INSERT and (blob is not None or xmp is not None)):
        whole = path.with_name("whole" + path.suffix)
        with path.open("rb") as file, whole.open("wb") as out:
            for piece in _INSERT[holder](FileBytes(file), blob, xmp):
                out.write(piece)
        os.replace(whole, path)
