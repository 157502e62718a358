"""What peers have in common: a codec that runs in this process, and one that pillow holds."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from sgicodec.bench.codec import Pixels8, RoundTrip, timed
from sgicodec.errors import PictureError, UsageError, require


class Peer(ABC):
    """A codec that runs in this process, on arrays.

    scale: its qualities by rising rate, for searches. stated: its settings, as a format of `quality` and of the peer.
    """

    name: ClassVar[str]
    scale: ClassVar[Sequence[float]]
    stated: ClassVar[str]
    ladder: tuple[float, ...]

    @abstractmethod
    def version(self) -> str: ...

    def settings(self, quality: float) -> str:
        """`stated` for a quality."""
        return self.stated.format(self, quality=quality)

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


class PillowPeer(Peer):
    """A codec of pillow: its name there, the feature that pillow needs for it and the library behind."""

    container: ClassVar[str]
    feature: ClassVar[str]
    library: ClassVar[str]

    @abstractmethod
    def options(self, quality: float) -> dict[str, Any]:
        """What pillow is to save with."""

    def version(self) -> str:
        require("PIL", self.name, "bench")
        import PIL
        from PIL import features

        if not features.check(self.feature):
            raise UsageError(f"{self.name} needs a pillow that holds {self.library}: pip install 'sgicodec[bench]'")
        return f"{self.library} {features.version(self.feature)} in pillow {PIL.__version__}"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        return pillow_encode(pixels, self.container, **self.options(quality))

    def decode(self, data: bytes) -> Pixels8:
        from PIL import Image

        try:
            with Image.open(io.BytesIO(data)) as picture:
                return np.asarray(picture.convert("RGB"))
        except Image.DecompressionBombError as error:
            raise ValueError(f"pillow refuses to open it: {error}") from error


def pillow_encode(pixels: Pixels8, container: str, **options: Any) -> bytes:
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, container, **options)
    return buffer.getvalue()
