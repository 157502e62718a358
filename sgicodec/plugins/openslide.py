"""Streams as slides: the interface of openslide-python's `OpenSlide`, for programs that were written for that."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from types import MappingProxyType, TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.recognition import looks_like_stream
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.decoder.view import inner_view, level_view
from sgicodec.errors import RegionError, UsageError, require
from sgicodec.metadata.georeference import resolution
from sgicodec.metadata.layouts import WITHOUT_ALPHA
from sgicodec.metadata.slides import magnification
from sgicodec.metadata.tiff import DESCRIPTION, described
from sgicodec.picture import Picture, nodata_mask, to_rgb8

if TYPE_CHECKING:
    from PIL.Image import Image


class Slide:
    """A stream as `openslide.OpenSlide` shows one. A context manager.

    Levels are the picture, its half, its quarter … down to 256 pixels. Regions are images of Pillow in RGBA,
    transparent where the picture has no pixels or no content. `properties` has `openslide.mpp-x`, `openslide.mpp-y`
    and what the levels are. Raises SgiError.
    """

    def __init__(self, source: Any) -> None:
        require("PIL", "a slide")
        self._stream = source if isinstance(source, Stream) else open_stream(source)
        self._levels = self._stream.levels

    def __enter__(self) -> Slide:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @classmethod
    def detect_format(cls, filename: str | os.PathLike[str]) -> str | None:
        """The name of this package for a stream, None for all else. Of a URL, by its name: nothing is fetched."""
        return "sgicodec" if looks_like_stream(filename) else None

    def close(self) -> None:
        """Closes the stream."""
        self._stream.close()

    @property
    def level_count(self) -> int:
        """How many levels there are."""
        return len(self._levels)

    @property
    def level_dimensions(self) -> tuple[tuple[int, int], ...]:
        """Width and height of each level."""
        return tuple((level.width, level.height) for level in self._levels)

    @property
    def dimensions(self) -> tuple[int, int]:
        """Width and height of the picture."""
        return self.level_dimensions[0]

    @property
    def level_downsamples(self) -> tuple[float, ...]:
        """How many of the picture's pixels lie along one of each level."""
        return tuple(level.downsample for level in self._levels)

    @property
    def properties(self) -> Mapping[str, str]:
        """What is known of the slide, under OpenSlide's names."""
        metadata = self._stream.metadata
        found = {"openslide.vendor": "sgicodec", "openslide.level-count": str(self.level_count)}
        for number, level in enumerate(self._levels):
            name = f"openslide.level[{number}]"
            sizes = {"width": level.width, "height": level.height, "downsample": level.downsample}
            found |= {f"{name}.{what}": f"{value:.15g}" for what, value in sizes.items()}
        scale = resolution(metadata.geo, metadata.exif)
        if scale is not None:
            found |= {f"openslide.mpp-{axis}": f"{size:.15g}" for axis, size in zip("xy", scale.microns, strict=True)}
        comment = described(metadata.exif).get(DESCRIPTION)
        if comment is not None:
            found["openslide.comment"] = comment.data.rstrip(b"\0").decode("utf-8", "replace")
            power = magnification(comment.data)
            if power is not None:
                found["openslide.objective-power"] = power
        return MappingProxyType(found)

    @property
    def associated_images(self) -> Mapping[str, Image]:
        """None: a stream has no label and no macro."""
        return MappingProxyType({})

    @property
    def color_profile(self) -> Any:
        """The ICC profile as Pillow's `ImageCmsProfile`, or None."""
        if self._stream.metadata.icc is None:
            return None
        from io import BytesIO

        from PIL import ImageCms

        return ImageCms.ImageCmsProfile(BytesIO(self._stream.metadata.icc))

    def get_best_level_for_downsample(self, downsample: float) -> int:
        """The smallest level that is at least as large as the picture divided by `downsample`."""
        fitting = [number for number, level in enumerate(self._levels) if level.downsample <= downsample]
        return max(fitting, default=0)

    def read_region(self, location: tuple[int, int], level: int, size: tuple[int, int]) -> Image:
        """An RGBA image of Pillow: `size` (width, height) pixels of a level, from `location` (x, y) on.

        The location counts pixels of the picture, at any level, and may lie outside it; what lies outside, or is
        nodata, is transparent. Raises RegionError for a level that is not there, UsageError for a negative size.
        """
        from PIL import Image

        if min(size) < 0:
            raise UsageError(f"size {size!r} is negative")
        if min(size) == 0:
            return Image.new("RGBA", size)
        stream = self._stream
        pixels = stream.read_region(location, level, size)
        shown = level_view(stream.header, self._levels, location, level, size)
        inner, left, top = inner_view(shown, stream.width, stream.height)
        samples, header = pixels.reshape(size[1], size[0], -1), stream.header
        picture = Picture(samples, header.channels, header.sample_range, blank=stream.nodata)
        rgba = np.zeros((size[1], size[0], 4), np.uint8)
        part = (slice(top, top + inner.rows), slice(left, left + inner.columns))
        rgba[part] = _rgba(picture)[part]
        image = Image.fromarray(rgba)
        if stream.metadata.icc is not None:
            image.info["icc_profile"] = stream.metadata.icc
        return image

    def get_thumbnail(self, size: tuple[int, int]) -> Image:
        """The picture in RGB on white, as large as fits into `size`, and no larger than it is."""
        from PIL import Image

        if min(size) < 1:
            raise RegionError(f"a size of {size[0]}×{size[1]} pixels holds no picture")
        stream = self._stream
        scale = min(1.0, size[0] / stream.width, size[1] / stream.height)
        asked = (max(1, math.floor(stream.width * scale + 1e-9)), max(1, math.floor(stream.height * scale + 1e-9)))
        image = Image.fromarray(_rgba(stream.picture(size=asked)))
        white = Image.new("RGB", image.size, "white")
        white.paste(image, None, image)
        if stream.metadata.icc is not None:
            white.info["icc_profile"] = stream.metadata.icc
        return white

    def set_cache(self, cache: object) -> None:
        """Does nothing: a stream keeps the tiles that it decoded."""


def _rgba(picture: Picture) -> NDArray[np.uint8]:
    """Colours and alpha [H, W, 4], as a screen shows them; without content they are transparent."""
    alpha = np.where(nodata_mask(picture), 0, 255).astype(np.uint8)
    if picture.alpha is not None:
        samples = picture.pixels[..., picture.alpha]
        most = 1.0 if samples.dtype.kind == "f" else float(np.iinfo(samples.dtype).max)
        alpha = np.minimum(alpha, np.rint(255 * np.clip(samples / most, 0, 1)).astype(np.uint8))
        colours = np.ascontiguousarray(picture.pixels[..., : picture.alpha])
        picture = Picture(colours, WITHOUT_ALPHA[picture.channels], picture.sample_range)
    return np.concatenate([to_rgb8(picture), alpha[..., None]], axis=2)
