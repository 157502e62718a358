"""The residual layer: what a stream lacks to be its picture, or near it (docs/format.md, "Residual layer")."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import range_coded
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import Stream
from sgicodec.device import Device
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.residual_grids import block_rects, residual_form
from sgicodec.errors import PictureError

__all__ = ["residual_layer"]

_CRC_BYTES = 4


def residual_layer(
    stream: Stream, windows: Windows, max_error: float, device: Device, exact_views: bool = False
) -> bytes:
    """The payload of the residual layer that brings an opened stream to the picture of `windows`, but for `max_error`
    levels; floats by so much. Alpha of 8 and 16 bits is exact. A layer that the stream has is left aside.
    exact_views: whether it shows every view.

    Raises PictureError for a picture that is not the stream's.
    """
    header, stream.lossy = stream.header, True
    _check_shape(header, windows)
    form = residual_form(header, (windows.read(*rect).pixels for rect in block_rects(header)), max_error, exact_views)
    blocks, whole = [], encode_header(header)
    with ThreadPoolExecutor(device.cores) as pool:
        waiting: deque[Future[_Block]] = deque()
        for rect in block_rects(header):
            given, drawn = _samples(windows.read(*rect).pixels), _samples(stream.picture(rect).pixels)
            waiting.append(pool.submit(_coded, given, drawn, whole, form))
            if len(waiting) > device.cores:
                blocks.append(waiting.popleft().result())
        blocks += [block.result() for block in waiting]
    table = [encode_varint(len(block.data)) + block.crc.to_bytes(_CRC_BYTES, "little") for block in blocks]
    return b"".join([form, *table, *(block.data for block in blocks)])


class _Block(NamedTuple):
    """A coded block, and the CRC-32 of its samples."""

    data: bytes
    crc: int


def _coded(samples: NDArray[np.float32], drawn: NDArray[np.float32], header: bytes, form: bytes) -> _Block:
    bits, ones, crc = _native.code_residual(samples, drawn, header, form)
    return _Block(range_coded(bits, ones), crc)


def _samples(pixels: NDArray[Any]) -> NDArray[np.float32]:
    return np.ascontiguousarray(pixels, np.float32)


def _check_shape(header: Header, windows: Windows) -> None:
    shape = windows.shape
    found = (shape.width, shape.height, shape.bands, str(shape.dtype))
    wanted = (header.width, header.height, header.spec.channels, header.sample_type)
    if found != wanted:
        names = [
            f"{width}×{height} pixels, {bands} channels, {dtype}" for width, height, bands, dtype in (found, wanted)
        ]
        raise PictureError(f"the picture has {names[0]}, the stream {names[1]}")
