"""Streams as a codec of Zarr 3, from arrays to bytes, which decodes of a chunk no more than is read."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from sgicodec.errors import require

require("zarr", "the codec for Zarr 3", "zarr")

from zarr.abc.codec import ArrayBytesCodec, ArrayBytesCodecPartialDecodeMixin  # noqa: E402
from zarr.abc.store import RangeByteRequest  # noqa: E402
from zarr.core.array_spec import ArraySpec  # noqa: E402
from zarr.core.buffer import Buffer, NDBuffer  # noqa: E402
from zarr.storage import StorePath  # noqa: E402

from sgicodec.decoder.stream import open_stream  # noqa: E402
from sgicodec.plugins.chunks import (  # noqa: E402
    check_chunk,
    checked_settings,
    decode_chunk,
    encode_chunk,
    read_selection,
)
from sgicodec.remote.range_file import BLOCK, RangeFile, Span  # noqa: E402

_NAME = "sgicodec"

_SMALL = 4 * BLOCK
"""Bytes of chunks that are fetched whole."""


@dataclass(frozen=True)
class SgiCodec(ArrayBytesCodec, ArrayBytesCodecPartialDecodeMixin):
    """Codes chunks [y, x] and [y, x, c], with any axes of one before, of uint8, uint16 or float32. It is lossy.

    channels: a layout of pictures, by default gray, rgb, or bands without a meaning. settings: of `sgicodec.encode`,
    such as quality=60, effort=3, sample_range and nodata. Samples that have the array's fill value, as beyond its edge,
    are kept exactly. Raises UsageError.
    """

    is_fixed_size = False

    channels: str | None = None
    settings: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __init__(self, channels: str | None = None, **settings: Any) -> None:
        object.__setattr__(self, "channels", channels)
        object.__setattr__(self, "settings", checked_settings(settings))

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> SgiCodec:
        """That of an array's metadata."""
        return cls(**data.get("configuration", {}))

    def to_dict(self) -> dict[str, Any]:
        """What stands in the array's metadata."""
        given = {} if self.channels is None else {"channels": self.channels}
        return {"name": _NAME, "configuration": given | dict(self.settings)}

    def validate(self, *, shape: tuple[int, ...], dtype: Any, chunk_grid: Any) -> None:
        """Raises UsageError for chunks that cannot be pictures."""
        check_chunk(getattr(chunk_grid, "chunk_shape", shape), dtype.to_native_dtype())

    def compute_encoded_size(self, input_byte_length: int, chunk_spec: ArraySpec) -> int:
        """Nobody knows."""
        raise NotImplementedError

    async def _encode_single(self, chunk_data: NDBuffer, chunk_spec: ArraySpec) -> Buffer:
        chunk, fill = chunk_data.as_numpy_array(), float(chunk_spec.fill_value)
        data = await asyncio.to_thread(encode_chunk, chunk, self.channels, self.settings, fill)
        return chunk_spec.prototype.buffer.from_bytes(data)

    async def _decode_single(self, chunk_data: Buffer, chunk_spec: ArraySpec) -> NDBuffer:
        dtype = chunk_spec.dtype.to_native_dtype()
        pixels = await asyncio.to_thread(decode_chunk, chunk_data.to_bytes(), chunk_spec.shape, dtype)
        return chunk_spec.prototype.nd_buffer.from_numpy_array(pixels)

    async def _decode_partial_single(self, byte_getter: Any, selection: Any, chunk_spec: ArraySpec) -> NDBuffer | None:
        source = await _source(byte_getter, chunk_spec)
        if source is None:
            return None

        def read() -> Any:
            with open_stream(source) as stream:
                return read_selection(stream, chunk_spec.shape, chunk_spec.dtype.to_native_dtype(), selection)

        pixels = await asyncio.get_running_loop().run_in_executor(_decoders(), read)
        return chunk_spec.prototype.nd_buffer.from_numpy_array(pixels)


@cache
def _decoders() -> ThreadPoolExecutor:
    """Threads that decode while they wait for a store, which may need all of the loop's own."""
    return ThreadPoolExecutor(thread_name_prefix="sgicodec")


async def _source(byte_getter: Any, chunk_spec: ArraySpec) -> bytes | RangeFile | None:
    """A small chunk's bytes, or a file that fetches parts of a large one; None where there is none.

    Only of a chunk that is an object of its own the size is known before it is read.
    """
    size = 0
    if isinstance(byte_getter, StorePath):
        try:
            size = await byte_getter.store.getsize(byte_getter.path)
        except FileNotFoundError:
            return None
    if size <= _SMALL:
        data = await byte_getter.get(chunk_spec.prototype)
        return None if data is None else bytes(data.to_bytes())
    loop = asyncio.get_running_loop()

    async def part(start: int, stop: int) -> bytes:
        found = await byte_getter.get(chunk_spec.prototype, RangeByteRequest(start, stop))
        if found is None or len(found) != stop - start:
            raise FileNotFoundError(f"{byte_getter}: it has changed while it was read")
        return bytes(found.to_bytes())

    async def parts(spans: list[Span]) -> list[bytes]:
        return await asyncio.gather(*(part(start, stop) for start, stop in spans))

    def fetch(spans: list[Span]) -> list[bytes]:
        """Called by another thread, as it blocks."""
        return asyncio.run_coroutine_threadsafe(parts(spans), loop).result()

    return RangeFile(size, fetch)
