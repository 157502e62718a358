"""What all peers have in common: a codec that runs in this process, and coding by pillow."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from sgicodec.bench.codec import Pixels8, RoundTrip, timed
from sgicodec.errors import PictureError, UsageError, require

__all__ = ["Peer", "pillow_decode", "pillow_encode", "pillow_version"]


class Peer(ABC):
    """A codec that runs in this process, on arrays. `scale` holds its qualities by rising rate, for searches."""

    name: ClassVar[str]
    scale: ClassVar[Sequence[float]]
    ladder: tuple[float, ...]

    @abstractmethod
    def version(self) -> str: ...

    @abstractmethod
    def settings(self, quality: float) -> str: ...

    @abstractmethod
    def encode(self, pixels: Pixels8, quality: float) -> bytes: ...

    @abstractmethod
    def decode(self, data: bytes) -> Pixels8: ...

    def round_trip(self, pixels: Pixels8, quality: float) -> RoundTrip:
        """Encode and decode in memory. Raises PictureError if the codec refuses the picture."""
        try:
            data, encode_seconds = timed(lambda: self.encode(pixels, quality))
            decoded, decode_seconds = timed(lambda: self.decode(data))
        except (OSError, ValueError, RuntimeError) as error:
            size = f"{pixels.shape[1]}x{pixels.shape[0]}"
            raise PictureError(f"{self.name} cannot code a picture of {size} pixels: {error}") from error
        return RoundTrip(data, decoded, encode_seconds, decode_seconds)


def pillow_version(name: str, feature: str, library: str) -> str:
    require("PIL", name, "bench")
    import PIL
    from PIL import features

    if not features.check(feature):
        raise UsageError(f"{name} needs a pillow that holds {library}: pip install 'sgicodec[bench]'")
    return f"{library} {features.version(feature)} in pillow {PIL.__version__}"


def pillow_encode(pixels: Pixels8, container: str, **options: Any) -> bytes:
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, container, **options)
    return buffer.getvalue()


def pillow_decode(data: bytes) -> Pixels8:
    from PIL import Image

    try:
        with Image.open(io.BytesIO(data)) as picture:
            return np.asarray(picture.convert("RGB"))
    except Image.DecompressionBombError as error:
        raise ValueError(f"pillow refuses to open it: {error}") from error
