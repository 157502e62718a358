"""EXIF, XMP and `geo` inside picture files, kept byte for byte.

OpenImageIO turns EXIF and XMP into attributes of its own and back, and on the way loses maker notes, many GPS fields
and any XMP that it does not know; of GeoTIFF it knows nothing. A little container syntax keeps them whole.
"""

from __future__ import annotations

import os
import struct
from dataclasses import replace
from pathlib import Path

from sgicodec.errors import PictureError
from sgicodec.metadata import bmp, exif, jp2, jpeg, jxl, photoshop, png, tiff, webp, xmp
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.filebytes import Bytes, FileBytes
from sgicodec.metadata.motion import Motion
from sgicodec.metadata.orientation import is_sideways

_INSERT = {"bmp": bmp.insert, "jpeg": jpeg.insert, "jpeg2000": jp2.insert, "webp": webp.insert}
_REWRITTEN = ("bmp", "jpeg", "jpeg2000")
"""Formats whose files are rewritten even without metadata: to declare alpha, to lose what OpenImageIO puts there."""


def extract(data: Bytes) -> Metadata:
    """EXIF, XMP and `geo` in the bytes of any picture file, which speak of the stored pixels; each None where there is
    none.
    """
    if data[:3] == jpeg.SIGNATURE:
        blob, xmp, geo = jpeg.find(data)
    elif data[:8] == png.SIGNATURE:
        blob, xmp, geo = png.find(data)
    elif webp.is_webp(data):
        blob, xmp, geo = *webp.find(data), None
    elif jxl.is_boxed(data):
        blob, xmp, geo = *jxl.find(data), None
    elif jp2.is_boxed(data):
        blob, xmp, geo = jp2.find(data)
    elif photoshop.is_psd(data):
        blob, xmp, geo = photoshop.find(data)
    else:
        blob, xmp, geo = tiff.find(data)
    return Metadata(exif=blob and exif.plain(blob), xmp=xmp or None, geo=geo)


def orientation(metadata: Metadata, other: int | None = None) -> int:
    """How pixels must be turned: as EXIF says, else `other`, what the file says elsewhere, else XMP."""
    stated = (exif.orientation(metadata.exif), other, xmp.orientation(metadata.xmp), 1)
    return next(value for value in stated if value is not None)


def upright(metadata: Metadata, orientation: int, width: int, height: int) -> Metadata:
    """EXIF and XMP of a picture of width × height stored pixels that was turned, so that nothing turns it again."""
    found = moved(metadata, Motion(width, height, orientation))
    return replace(found, exif=found.exif and exif.upright(found.exif), xmp=found.xmp and xmp.upright(found.xmp))


def turned_already(metadata: Metadata, width: int, height: int, turn: int | None = None) -> Metadata:
    """The same of a picture that its library has turned, to width × height: by `turn`, else as EXIF says. If the size
    that EXIF states lies like the picture it was turned, too.
    """
    turn, stated = turn or orientation(metadata), exif.size(metadata.exif)
    if is_sideways(turn) and stated is not None and (stated[0] > stated[1]) == (width > height):
        turn = 1
    return upright(metadata, turn, *((height, width) if is_sideways(turn) else (width, height)))


def moved(metadata: Metadata, motion: Motion) -> Metadata:
    """EXIF and XMP of a picture whose pixels moved."""
    blob, packet = metadata.exif, metadata.xmp
    return replace(metadata, exif=blob and exif.moved(blob, motion), xmp=packet and xmp.moved(packet, motion))


def copies(holder: str) -> int:
    """How many times a file in the format `holder` may stand on the disk while `embed` works on it."""
    return 1 if holder == "tiff" or holder not in _INSERT else 2


def embed(path: Path, holder: str, metadata: Metadata, bands: int | None = None) -> None:
    """Put EXIF, XMP and `geo` into the file that was just written at `path` in the format `holder`, as far as it has
    a place for them and its writer, that of PNG, has not put them there. bands: as for `tiff.insert`.

    Raises PictureError if they do not fit.
    """
    blob, packet = metadata.exif, metadata.xmp
    if holder == "tiff":
        try:
            tiff.insert(path, blob, packet, metadata.geo, bands)
        except struct.error as error:
            raise PictureError(f"tiff cannot hold its metadata: {error}") from error
    elif holder in _REWRITTEN or (holder in _INSERT and (blob is not None or packet is not None)):
        whole = path.with_name("whole" + path.suffix)
        with path.open("rb") as file, whole.open("wb") as out:
            for piece in _INSERT[holder](FileBytes(file), metadata):
                out.write(piece)
        os.replace(whole, path)
