"""What a worker does with a tile: it is sent the pixels, or reads them itself."""

from __future__ import annotations

import atexit
import threading
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from sgicodec.encoder import EncodedTile, encode_tile
from sgicodec.encoding import keep_to_one_torch_thread
from sgicodec.errors import PictureError
from sgicodec.image import Picture, Source, open_source
from sgicodec.plan import Plan

__all__ = ["ReadingTask", "TileTask"]


@dataclass(frozen=True)
class TileTask:
    """Fits the pixels that come with the tile's number."""

    plan: Plan

    def __call__(self, number: int, window: Picture) -> EncodedTile:
        """Fits the tile."""
        if threading.current_thread() is not threading.main_thread():
            keep_to_one_torch_thread()
        return encode_tile(window, self.plan, number)


@dataclass(frozen=True)
class ReadingTask:
    """Reads the tile's pixels from `place`, a path or a URL, which stays open between tiles."""

    plan: Plan
    place: str

    def __call__(self, number: int, _: None) -> EncodedTile:
        """Fits the tile. Raises PictureError for another picture than the plan's."""
        header = self.plan.header
        with _reading:
            source = _opened(self.place, header.sample_range if header.sample_type == "float32" else None)
            found = source.width, source.height, source.channels, str(source.dtype)
            if found != (header.width, header.height, header.channels, header.sample_type):
                raise PictureError(f"{self.place}: this is another picture than the one being encoded")
            window = source.read(*header.grid.rect(number))
        return TileTask(self.plan)(number, replace(window, metadata=self.plan.place_of_windows))


_reading = threading.Lock()


@lru_cache(maxsize=1)
def _opened(place: str, sample_range: tuple[float, float] | None) -> Source:
    if "://" not in place:
        return open_source(place, sample_range=sample_range)
    try:
        import fsspec
    except ImportError as error:
        raise PictureError(f"{place}: URLs need fsspec; install sgicodec[cluster]") from error
    try:
        with fsspec.open(place, "rb") as file:
            content: Any = file
            return open_source(content, sample_range=sample_range)
    except OSError as error:
        raise PictureError(f"{place}: {error}") from error


atexit.register(_opened.cache_clear)
