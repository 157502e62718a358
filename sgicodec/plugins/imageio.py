"""Streams in imageio, once this module is imported: `imageio.v3.imread`, `imwrite(plugin="sgicodec")` and the rest.

imageio finds no plugins by entry points. Its reader of Silicon Graphics' `.sgi` goes on, and so does its writer.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import RegionError, UsageError, require

require("imageio", "the plugin for imageio", "viewers")

import imageio.config  # noqa: E402
from imageio.config.extensions import FileExtension  # noqa: E402
from imageio.config.plugins import PluginConfig  # noqa: E402
from imageio.core.request import InitializationError, IOMode, Request  # noqa: E402
from imageio.core.v3_plugin_api import ImageProperties, PluginV3  # noqa: E402

from sgicodec.bitstream.container import SIGNATURE  # noqa: E402
from sgicodec.decoder.stream import Stream, open_stream  # noqa: E402

_READER = "sgicodec-reader"


class SgiPlugin(PluginV3):
    """One stream, which is one image."""

    _is_ours = False

    def __init__(self, request: Request) -> None:
        """Raises InitializationError for a file that is no stream, StreamError for a damaged one."""
        super().__init__(request)
        self._stream: Stream | None = None
        if request.mode.io_mode == IOMode.read:
            if request.firstbytes[: len(SIGNATURE)] != SIGNATURE:
                raise InitializationError("this is no stream of sgicodec")
            self._stream = open_stream(request.get_file())
        self._is_ours = True

    def close(self) -> None:
        """Closes the file, unless it was refused: then it is another plugin's."""
        if self._is_ours:
            super().close()

    def read(self, *, index: Any = 0, **view: Any) -> NDArray[Any]:
        """Samples [h, w] of gray, else [h, w, C]. Raises SgiError.

        view: region, scale, size and dtype, as of `Stream.read`.
        """
        pixels = self._opened(index).read(**view)
        return pixels[None] if index is Ellipsis else pixels

    def iter(self, **view: Any) -> Iterator[NDArray[Any]]:
        """The one image."""
        yield self.read(**view)

    def write(self, ndimage: Any, **settings: Any) -> bytes | None:
        """Writes one image. settings: of `sgicodec.encode`, such as quality=60. Raises SgiError."""
        from sgicodec.encoder.one_call import encode

        if isinstance(ndimage, list | tuple):
            if len(ndimage) != 1:
                raise UsageError(f"{len(ndimage)} images; a stream holds one")
            ndimage = ndimage[0]
        file = self.request.get_file()
        file.write(encode(np.asarray(ndimage), **settings))
        return file.getvalue() if self.request.raw_uri == "<bytes>" else None  # type: ignore[attr-defined, no-any-return]

    def properties(self, index: Any = 0) -> ImageProperties:
        """Shape and type, from the header alone."""
        stream = self._opened(index)
        lead = (1,) if index is Ellipsis else ()
        return ImageProperties((*lead, *stream.shape), stream.dtype, is_batch=index is Ellipsis)

    def metadata(self, index: Any = 0, exclude_applied: bool = True) -> dict[str, Any]:
        """ICC profile, EXIF, XMP, geo tags and nodata, as far as there are any."""
        stream = self._opened(index)
        blobs = stream.metadata
        found: dict[str, Any] = {"channels": stream.header.channels, "nodata": stream.nodata}
        found |= {"icc_profile": blobs.icc, "exif": blobs.exif, "xmp": blobs.xmp, "geo": blobs.geo}
        return {name: value for name, value in found.items() if value is not None}

    def _opened(self, index: Any) -> Stream:
        if self._stream is None:
            raise UsageError("it is open for writing")
        if index not in (0, None) and index is not Ellipsis:
            raise RegionError(f"image {index}; a stream holds one, image 0")
        return self._stream


class SgiReader(SgiPlugin):
    """The same for all files that are called `.sgi`, of which it reads streams and writes none."""

    def __init__(self, request: Request) -> None:
        if request.mode.io_mode == IOMode.write:
            raise InitializationError("a name that ends in .sgi is written by Silicon Graphics' plugin")
        super().__init__(request)


def register() -> None:
    """Makes streams known to imageio, which importing this module does."""
    plugins: Any = imageio.config.known_plugins
    plugins["sgicodec"] = PluginConfig("sgicodec", "SgiPlugin", __name__)  # type: ignore[no-untyped-call]
    plugins[_READER] = PluginConfig(_READER, "SgiReader", __name__)  # type: ignore[no-untyped-call]
    known: Any = imageio.config.known_extensions
    if not any(_READER in each.priority for each in known[".sgi"]):
        ours: Any = FileExtension(extension=".sgi", priority=[_READER], name="sgicodec")  # type: ignore[no-untyped-call]
        known[".sgi"].insert(0, ours)


register()
