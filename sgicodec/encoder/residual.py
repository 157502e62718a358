"""The residual layer: what a stream lacks to be its picture, or near it (docs/format.md, "Residual layer")."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import range_coded
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import Stream
from sgicodec.device import Device
from sgicodec.encoder.graphics import Repeats, may_have_views
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual_grids import residual_form
from sgicodec.errors import PictureError
from sgicodec.model.steps import quality_index
from sgicodec.model.tile_grid import Rect

__all__ = ["residual_layer", "with_exact_views"]

_CRC_BYTES = 4
_LARGE_LMBDA = 1e4
"""At which a model of one Gaussian is best."""
_SAMPLES = 12
"""Blocks by which a picture is judged."""


def residual_layer(stream: Stream, windows: Windows, max_error: float, device: Device) -> bytes:
    """The payload of the residual layer that brings an opened stream to the picture of `windows`, but for `max_error`
    levels; floats by so much. Alpha of 8 and 16 bits is exact. A layer that the stream has is left aside.

    Raises PictureError for a picture that is not the stream's.
    """
    header, stream.lossy = stream.header, True
    _check_shape(header, windows)
    form = residual_form(header, (windows.read(*rect).pixels for rect in _rects(header)), max_error)
    blocks, whole = [], encode_header(header)
    with ThreadPoolExecutor(device.cores) as pool:
        waiting: deque[Future[_Block]] = deque()
        for rect in _rects(header):
            given, drawn = _samples(windows.read(*rect).pixels), _samples(stream.picture(rect).pixels)
            waiting.append(pool.submit(_coded, given, drawn, whole, form))
            if len(waiting) > device.cores:
                blocks.append(waiting.popleft().result())
        blocks += [block.result() for block in waiting]
    table = [encode_varint(len(block.data)) + block.crc.to_bytes(_CRC_BYTES, "little") for block in blocks]
    return b"".join([form, *table, *(block.data for block in blocks)])


def with_exact_views(windows: Windows, plan: Plan) -> Plan:
    """The plan of a lossless stream that shows exact pixels at every scale, over a lossy picture that takes next to
    nothing, for text, line art and screens: where a residual layer is asked for, but no quality of what is below; and
    where neither is, but the stream will probably be no larger than a lossy one of this quality.
    """
    settings, header = plan.settings, plan.header
    is_free = (settings.lmbda, settings.target) == (None, None) and settings.chosen_profile.has_overviews
    if not is_free or not may_have_views(header) or (settings.max_error is not None and settings.quality is not None):
        return plan
    rects = list(_rects(header))
    if settings.max_error is None:
        rects = rects[:: -(-len(rects) // _SAMPLES)]
    blocks, repeats = [], Repeats()
    for rect in rects:
        blocks.append(windows.read(*rect).pixels)
        repeats.see(blocks[-1])
        if settings.max_error is not None:
            blocks.clear()
    if not repeats.are_usual:
        return plan
    if settings.max_error is None:
        if _bits_of_pixel(header, blocks) > 0.8 * 2 ** ((settings.chosen_quality - 50) / 20):
            return plan
        plan = replace(plan, settings=replace(settings, max_error=0))
    plan = replace(plan, settings=replace(plan.settings, effort=1, steps=None))
    return plan.at(_LARGE_LMBDA, quality_index(_LARGE_LMBDA))


def _bits_of_pixel(header: Header, blocks: list[NDArray[Any]]) -> float:
    """What a residual layer takes of these blocks, without loss and whatever is drawn below."""
    form, bits, count = residual_form(header, blocks, 0), 0.0, 0
    for block in map(_samples, blocks):
        coded, ones, _ = _native.code_residual(block, np.zeros_like(block), encode_header(header), form)
        bits -= float(np.log2(np.where(coded, ones, 65536 - ones) / 65536).sum())
        count += block.shape[0] * block.shape[1]
    return bits / count


class _Block(NamedTuple):
    """A coded block, and the CRC-32 of its samples."""

    data: bytes
    crc: int


def _coded(samples: NDArray[np.float32], drawn: NDArray[np.float32], header: bytes, form: bytes) -> _Block:
    bits, ones, crc = _native.code_residual(samples, drawn, header, form)
    return _Block(range_coded(bits, ones), crc)


def _samples(pixels: NDArray[Any]) -> NDArray[np.float32]:
    return np.ascontiguousarray(pixels, np.float32)


def _rects(header: Header) -> Iterator[Rect]:
    """The blocks (x, y, width, height) of a picture, in rows."""
    side = _native.RESIDUAL_BLOCK
    for y in range(0, header.height, side):
        for x in range(0, header.width, side):
            yield x, y, min(side, header.width - x), min(side, header.height - y)


def _check_shape(header: Header, windows: Windows) -> None:
    shape = windows.shape
    found = (shape.width, shape.height, shape.bands, str(shape.dtype))
    wanted = (header.width, header.height, header.spec.channels, header.sample_type)
    if found != wanted:
        names = [
            f"{width}×{height} pixels, {bands} channels, {dtype}" for width, height, bands, dtype in (found, wanted)
        ]
        raise PictureError(f"the picture has {names[0]}, the stream {names[1]}")
