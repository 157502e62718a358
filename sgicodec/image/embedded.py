"""EXIF and XMP inside picture files, kept byte for byte.

OpenImageIO turns both into attributes of its own and back, and on the way loses maker notes, many GPS fields
and any XMP that it does not know. A little container syntax keeps them whole.
"""

from __future__ import annotations

import struct
from pathlib import Path

from ..errors import PictureError
from . import exif, jpeg, png, webp
from .ifd import Bytes
from .picture import Metadata

__all__ = ["embed", "extract"]


def extract(data: Bytes) -> tuple[bytes | None, bytes | None]:
    """EXIF and XMP, both with the orientation set to 1, in the bytes of any picture file; None where there is
    none.
    """
    if data[:3] == jpeg.SIGNATURE:
        blob, xmp = jpeg.find(data)
    elif data[:8] == png.SIGNATURE:
        blob, xmp = png.find(data)
    elif webp.is_webp(data):
        blob, xmp = webp.find(data)
    else:
        blob, xmp = exif.from_tiff(data)
    return blob and exif.upright(blob), xmp and exif.upright_xmp(xmp)


def embed(path: Path, holder: str, metadata: Metadata) -> None:
    """Put EXIF and XMP into the file that was just written at `path` in the format `holder`; others stay as
    they are.

    Raises PictureError if they do not fit.
    """
    blob, xmp = metadata.exif, metadata.xmp
    if holder == "tiff":
        try:
            exif.into_tiff(path, blob, xmp)
        except struct.error as error:
            raise PictureError(f"tiff cannot hold its EXIF: {error}") from error
    elif holder in ("jpeg", "png"):
        insert = jpeg.insert if holder == "jpeg" else png.insert
        path.write_bytes(insert(path.read_bytes(), blob, xmp))
    elif holder == "webp" and (blob is not None or xmp is not None):
        path.write_bytes(webp.insert(path.read_bytes(), blob, xmp))
