"""HEIF pictures (HEIC), by libheif."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError
from sgicodec.image.decoded_picture import DecodedPicture
from sgicodec.metadata import exif
from sgicodec.picture import Metadata

__all__ = ["HeifReader"]

_COUNTS = {"L": 1, "LA": 2, "RGB": 3, "RGBA": 4}


class HeifReader(DecodedPicture):
    """An open file: its primary picture, turned and cropped as the file says; 10 and 12 bits become 16."""

    kind = "heif by libheif"

    def __init__(self, path: Path) -> None:
        """Raises PictureError for what libheif does not read."""
        import pillow_heif

        try:
            self._image = pillow_heif.open_heif(path, convert_hdr_to_8bit=False, hdr_to_16bit=False)
        except Exception as error:
            raise PictureError(self._damage(error)) from error
        mode, _, bits = self._image.mode.partition(";")
        self._bits = int(bits or 8)
        if mode not in _COUNTS or not 8 <= self._bits <= 16:
            raise PictureError(f"its pixels are of mode {self._image.mode}, which cannot be read")
        self._channels = _COUNTS[mode]

    def _shape(self) -> tuple[int, int, int, str]:
        return *self._image.size, self._channels, "uint8" if self._bits == 8 else "uint16"

    def _decoded(self) -> npt.NDArray[Any]:
        pixels = np.asarray(self._image)
        if self._bits in (8, 16):
            return pixels
        most = (1 << self._bits) - 1
        return (pixels.astype(np.uint32) * 65535 // most).astype(np.uint16)

    @property
    def associated(self) -> bool:
        """As the file declares."""
        return bool(self._image.premultiplied_alpha)

    def metadata(self) -> Metadata:
        """ICC profile, EXIF and XMP. The file's own turns count (ISO/IEC 23008-12), not the orientation in these."""
        info = self._image.info
        blob, xmp = info.get("exif"), info.get("xmp")
        return Metadata(
            icc=info.get("icc_profile") or None,
            exif=exif.upright(blob) if blob else None,
            xmp=exif.upright_xmp(xmp) if xmp else None,
        )

    def close(self) -> None:
        """Nothing is open: libheif has read the file."""
