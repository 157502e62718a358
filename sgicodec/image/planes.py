"""Planes of a TIFF file, a channel each, as the bands of one picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.arrays import Samples
from sgicodec.image.decoded_picture import Reader
from sgicodec.metadata import geo
from sgicodec.metadata.gdal_items import named_bands
from sgicodec.picture import Metadata

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec


class Planes(Reader):
    """An open picture of one band from each plane, which has an `ImageInput` of its own: each goes on from where it
    stands. names: of the bands.
    """

    layout = "multi"

    def __init__(self, opened: Callable[[], Any], header: ImageSpec, planes: Sequence[int], names: Sequence[str]):
        self._images, self._planes = [opened() for _ in planes], planes
        self._header, self._names, self.kind = header, names, self._images[0].format_name()

    def spec(self) -> ImageSpec:
        """The header of the first plane, with all bands."""
        import OpenImageIO as oiio

        spec = oiio.ImageSpec(self._header)
        spec.nchannels = len(self._planes)
        spec.channelnames = tuple(f"channel{number}" for number in range(len(self._planes)))
        spec.alpha_channel = -1
        return spec

    def metadata(self) -> Metadata:
        """The names of bands."""
        return Metadata(geo=geo.pack(named_bands(self._names)))

    def read_tiles(self, *where: Any) -> Samples | None:
        """As that of an `ImageInput`."""
        return self._read("read_tiles", where)

    def read_scanlines(self, *where: Any) -> Samples | None:
        """As that of an `ImageInput`."""
        return self._read("read_scanlines", where)

    def _read(self, method: str, where: tuple[Any, ...]) -> Samples | None:
        inner, form = where[1:-3], where[-1]
        found = []
        for image, plane in zip(self._images, self._planes, strict=True):
            samples = getattr(image, method)(plane, *inner, 0, 1, form)
            if samples is None:
                return None
            found.append(np.asarray(samples))
        return np.stack([samples.reshape(samples.shape[:2]) for samples in found], axis=-1)

    def geterror(self) -> str:
        """The first complaint of one of the inputs; all are cleared."""
        said = [str(image.geterror()) for image in self._images]
        return next(filter(None, said), "")

    def close(self) -> None:
        """Close the file."""
        for image in self._images:
            with suppress(Exception):
                image.close()
