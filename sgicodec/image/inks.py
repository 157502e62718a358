"""Cyan, magenta, yellow and black as RGB, by the plain formula of OpenImageIO, which knows four channels alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.arrays import Samples
from sgicodec.image.alpha import unassociate
from sgicodec.image.decoded_picture import Reader
from sgicodec.metadata import ifd

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

    from sgicodec.metadata.filebytes import Bytes


_INK_SET, _EXTRA_SAMPLES = 332, 338
_CMYK, _SEPARATED = 1, 5
_ASSOCIATED, _UNASSOCIATED = 1, 2


def rgb_of_inks(inks: Samples) -> Samples:
    """RGB [h, w, 3] of cyan, magenta, yellow and black [h, w, 4], in the same type."""
    largest = float(np.iinfo(inks.dtype).max) if inks.dtype.kind in "iu" else 1.0
    left = 1 - inks.astype(np.float32) / np.float32(largest)
    colours = left[..., :3] * left[..., 3:]
    return colours.astype(inks.dtype) if inks.dtype.kind == "f" else np.rint(colours * largest).astype(inks.dtype)


def extra_samples(data: Bytes, spec: ImageSpec) -> list[int] | None:
    """What a TIFF file says of the samples that follow its four inks; None for all other files."""
    if spec.get_int_attribute("tiff:PhotometricInterpretation", -1) != _SEPARATED or spec.nchannels < 5:
        return None
    found = ifd.entries(data, {_INK_SET, _EXTRA_SAMPLES})
    if _INK_SET in found and found[_INK_SET].short != _CMYK:
        return None
    extra = found[_EXTRA_SAMPLES].data if _EXTRA_SAMPLES in found else b""
    stated = [int(value) for value in np.frombuffer(extra[: len(extra) // 2 * 2], "<u2")]
    return (stated + [0] * spec.nchannels)[: spec.nchannels - 4]


class Inks(Reader):
    """An open picture of four inks and more samples as RGB, with alpha if one of these is; the others are left out.

    It stands before an `ImageInput` with this header, whose samples it reads. notes: what is left out.
    """

    def __init__(self, image: Any, header: ImageSpec, extra: list[int]) -> None:
        self._image, self._header, self.kind = image, header, image.format_name()
        kinds = [kind in (_ASSOCIATED, _UNASSOCIATED) for kind in extra]
        self._alpha = 4 + kinds.index(True) if any(kinds) else None
        self._associated = self._alpha is not None and extra[self._alpha - 4] == _ASSOCIATED

        left_out = len(extra) - any(kinds)
        self.notes = (f"{left_out} of its samples, beside four inks, are left out",) if left_out else ()

    def spec(self) -> ImageSpec:
        """The header in RGB or RGBA, whose alpha is unassociated."""
        import OpenImageIO as oiio

        spec = oiio.ImageSpec(self._header)
        spec.nchannels = 3 if self._alpha is None else 4
        spec.channelnames = ("R", "G", "B", "A")[: spec.nchannels]
        spec.alpha_channel = -1 if self._alpha is None else 3
        spec.attribute("oiio:UnassociatedAlpha", 1)
        return spec

    def read_tiles(self, *where: Any) -> Samples | None:
        """As that of an `ImageInput`."""
        return self._rgb(self._image.read_tiles, where)

    def read_scanlines(self, *where: Any) -> Samples | None:
        """As that of an `ImageInput`."""
        return self._rgb(self._image.read_scanlines, where)

    def _rgb(self, method: Any, where: tuple[Any, ...]) -> Samples | None:
        found = method(*where[:-3], 0, self._header.nchannels, self._header.format)
        if found is None:
            return None
        samples = np.asarray(found)
        if self._alpha is None:
            return rgb_of_inks(samples[..., :4])
        with_alpha = samples[..., [0, 1, 2, 3, self._alpha]]
        if self._associated:
            with_alpha = unassociate(with_alpha)
        return np.concatenate([rgb_of_inks(with_alpha[..., :4]), with_alpha[..., 4:]], axis=-1)

    def geterror(self) -> str:
        """What the picture behind complains of."""
        return str(self._image.geterror())

    def close(self) -> None:
        """Close the picture behind."""
        self._image.close()
