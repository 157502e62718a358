"""Streams as a codec of numcodecs: a compressor of Zarr 2, or of anything that uses numcodecs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import require

require("numcodecs", "the codec for numcodecs", "zarr")

from numcodecs.abc import Codec  # noqa: E402
from numcodecs.compat import ensure_bytes, ndarray_copy  # noqa: E402

from sgicodec.decoder.one_call import decode  # noqa: E402
from sgicodec.plugins.chunks import check_chunk, checked_settings, encode_chunk  # noqa: E402


class Sgi(Codec):  # type: ignore[misc]
    """Codes chunks [y, x] and [y, x, c], with any axes of one before, of uint8, uint16 or float32. It is lossy.

    channels: a layout of pictures, by default gray, rgb, or bands without a meaning. settings: of `sgicodec.encode`,
    such as quality=60, effort=3, sample_range and nodata, such as the array's fill value. Raises UsageError.
    """

    codec_id = "sgicodec"

    def __init__(self, channels: str | None = None, **settings: Any) -> None:
        self.channels, self.settings = channels, checked_settings(settings)

    def encode(self, buf: Any) -> bytes:
        """The stream of a chunk."""
        chunk = np.asarray(buf)
        check_chunk(chunk.shape, chunk.dtype)
        return encode_chunk(chunk, self.channels, self.settings)

    def decode(self, buf: Any, out: Any = None) -> NDArray[Any]:
        """The samples of a stream [y, x] or [y, x, c], in `out` if it is given."""
        pixels = decode(ensure_bytes(buf))
        return pixels if out is None else np.asarray(ndarray_copy(pixels, out))

    def get_config(self) -> dict[str, Any]:
        """What makes such a codec again."""
        given = {} if self.channels is None else {"channels": self.channels}
        return {"id": self.codec_id} | given | self.settings

    def __repr__(self) -> str:
        given = {} if self.channels is None else {"channels": self.channels}
        return f"Sgi({', '.join(f'{name}={value!r}' for name, value in (given | self.settings).items())})"
