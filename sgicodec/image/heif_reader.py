"""HEIF pictures (HEIC), by libheif."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, require
from sgicodec.image.decoded_picture import DecodedPicture, stated_metadata, stretched
from sgicodec.image.pages import check_page
from sgicodec.metadata.left_behind import are_foreign
from sgicodec.picture import Metadata

_COUNTS = {"L": 1, "LA": 2, "RGB": 3, "RGBA": 4, "RGBa": 4}


class HeifReader(DecodedPicture):
    """An open file: its primary picture, turned and cropped as the file says; 10 and 12 bits become 16."""

    kind = "heif by libheif"
    in_library = 4

    def __init__(self, path: Path, page: int | None = None) -> None:
        """page: from 1, the primary one first.

        Raises PictureError for what libheif does not read, UsageError for a page that is not there, MissingExtraError
        without libheif.
        """
        require("pillow_heif", "reading it", "heic")
        import pillow_heif

        try:
            file = pillow_heif.open_heif(path, convert_hdr_to_8bit=False, hdr_to_16bit=False)
        except Exception as error:
            raise PictureError(self._damage(error)) from error
        if not len(file):
            raise PictureError("the file is damaged or cut off: it holds no picture")
        self.pages, first = len(file), file.primary_index
        check_page(page, self.pages)
        self._image = file[[first, *(index for index in range(self.pages) if index != first)][(page or 1) - 1]]
        mode, _, bits = self._image.mode.partition(";")
        self.bits = int(bits or 8)
        if mode not in _COUNTS or not 8 <= self.bits <= 16:
            raise PictureError(f"its pixels are of mode {self._image.mode}, which cannot be read")
        self._channels = _COUNTS[mode]

    def _shape(self) -> tuple[int, int, int, str]:
        return *self._image.size, self._channels, "uint8" if self.bits == 8 else "uint16"

    def _decoded(self) -> npt.NDArray[Any]:
        return stretched(np.asarray(self._image), self.bits)

    @property
    def associated(self) -> bool:
        """As the file declares."""
        return bool(self._image.premultiplied_alpha)

    def left_behind(self) -> list[str]:
        """Colours that it numbers, and pictures beside its own."""
        info: dict[str, Any] = dict(self._image.info)
        lost = []
        numbers = info.get("nclx_profile")
        if numbers and "icc_profile" not in info:
            stated = (int(numbers["color_primaries"]), int(numbers["transfer_characteristics"]))
            lost = ["colour space (nclx)"] if are_foreign(stated) else []
        if info.get("aux") or info.get("depth_images"):
            lost.append("further pictures (a gain map, depth)")
        return lost

    def metadata(self) -> Metadata:
        """ICC profile, EXIF and XMP. The file's own turns count (ISO/IEC 23008-12), not the orientation in these."""
        return stated_metadata(self._image.info)
