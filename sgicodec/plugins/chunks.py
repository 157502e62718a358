"""Chunks of arrays as streams: which axes are rows, columns and channels, and what is decoded of a selection."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder.indexing import indexed_region
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.errors import CorruptStreamError, UsageError
from sgicodec.picture import equal_samples

Shape = tuple[int, ...]


def check_chunk(shape: Shape, dtype: np.dtype[Any]) -> None:
    """Raises UsageError for chunks that cannot be pictures."""
    _picture_shape(shape)
    if dtype not in (np.uint8, np.uint16, np.float32):
        raise UsageError(f"chunks of {dtype}; sgicodec codes uint8, uint16 and float32")


def _picture_shape(shape: Shape) -> Shape:
    """(y, x) or (y, x, c) of a chunk, whose leading axes of one do not count."""
    lead = next((axis for axis, side in enumerate(shape[:-2]) if side != 1), max(0, len(shape) - 2))
    found = shape[lead:]
    if len(found) not in (2, 3) or 0 in found:
        raise UsageError(f"chunks of shape {shape}; they must be [y, x] or [y, x, c], with any axes of one before")
    return found


def checked_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of an encode, as JSON has them: "NaN" for not-a-number, lists for tuples. Raises UsageError for
    others.
    """
    from sgicodec.encoder.settings import EncodeSettings

    unknown = settings.keys() - EncodeSettings.__dataclass_fields__.keys() - set(_SAMPLE_SETTINGS)
    if unknown:
        raise UsageError(f"there is no setting {min(unknown)!r}")
    EncodeSettings(**{name: value for name, value in settings.items() if name not in _SAMPLE_SETTINGS})
    stated = {name: _as_json(value) if name in _SAMPLE_SETTINGS else value for name, value in settings.items()}
    _sample_settings(stated)
    return stated


_SAMPLE_SETTINGS = ("sample_range", "nodata")
"""Settings that say what samples mean."""

_RANGES = ("used", "type")


def _as_json(value: Any) -> Any:
    if isinstance(value, tuple | list | np.ndarray):
        return [_as_json(each) for each in value]
    number = value.item() if isinstance(value, np.generic) else value
    if isinstance(number, float) and not math.isfinite(number):
        return "NaN" if math.isnan(number) else "Infinity" if number > 0 else "-Infinity"
    return number


def _sample_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Those of `_SAMPLE_SETTINGS` that are set, as `as_picture` takes them. Raises UsageError for what is none."""
    found = {name: settings[name] for name in _SAMPLE_SETTINGS if settings.get(name) is not None}
    try:
        if "nodata" in found:
            found["nodata"] = float(found["nodata"])
        if found.get("sample_range", "used") not in _RANGES:
            low, high = (tuple(level) if isinstance(level, list) else float(level) for level in found["sample_range"])
            found["sample_range"] = low, high
    except (TypeError, ValueError):
        stated = ", ".join(f"{name} {value!r}" for name, value in found.items())
        numbers = "nodata is a number, sample_range is used, type, two numbers, or two lists with one for each band"
        raise UsageError(f"{stated}; {numbers}") from None
    return found


def encode_chunk(
    chunk: NDArray[Any], channels: str | None, settings: Mapping[str, Any], fill: float | None = None
) -> bytes:
    """The stream of a chunk. channels: a layout of pictures; by default gray and rgb for one and three channels, and
    bands without a meaning for all others: none of them is taken for alpha. fill: what stands for nothing where no
    other nodata is set; 0 only where whole rows or columns at the end hold nothing else, as at the edge of an array.
    """
    from sgicodec.encoder.pipeline import encode_all_channels
    from sgicodec.encoder.settings import EncodeSettings
    from sgicodec.image.conversion import as_picture

    shape = _picture_shape(chunk.shape)
    count = shape[2] if len(shape) == 3 else 1
    layout = channels or {1: "gray", 3: "rgb"}.get(count, "multi")
    pixels = np.ascontiguousarray(chunk).reshape(*shape[:2], count)
    samples = _sample_settings(settings)
    if "nodata" not in samples and fill is not None and _is_padded(pixels, fill):
        samples["nodata"] = fill
    picture = as_picture(pixels, channels=layout, **samples)
    rest = {name: value for name, value in settings.items() if name not in _SAMPLE_SETTINGS}
    return encode_all_channels(picture, EncodeSettings(**rest))


def _is_padded(pixels: NDArray[Any], fill: float) -> bool:
    """Whether a fill value stands for nothing in [h, w, c]: any other than 0 does where it occurs."""
    filled = equal_samples(pixels, fill)
    if fill != 0:
        return bool(filled.any())
    return bool(filled[-1].all() or filled[:, -1].all())


def decode_chunk(data: bytes, shape: Shape, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The samples of a chunk. Raises StreamError, CorruptStreamError if it has another shape or type."""
    with open_stream(data) as stream:
        _check(stream, shape, dtype)
        return stream.read().reshape(shape)


def read_selection(stream: Stream, shape: Shape, dtype: np.dtype[Any], selection: Any) -> NDArray[Any]:
    """What numpy's `chunk[selection]` is, for which no more is decoded than the rectangle that holds it."""
    _check(stream, shape, dtype)
    lead = len(shape) - len(_picture_shape(shape))
    keys = selection if isinstance(selection, tuple) else (selection,)
    if len(keys) != len(shape) or not all(isinstance(key, slice | int | np.integer) for key in keys):
        return np.asarray(stream.read().reshape(shape)[selection])
    inner = slice(lead, lead + 2)
    region, touched = indexed_region(keys[inner], shape[inner])
    width, height = region[2:]
    if 0 in (width, height):
        return np.asarray(np.empty(shape, dtype)[selection])
    part = stream.read(region).reshape(*shape[:lead], height, width, *shape[lead + 2 :])
    return np.asarray(part[(*keys[:lead], *touched, *keys[lead + 2 :])])


def _check(stream: Stream, shape: Shape, dtype: np.dtype[Any]) -> None:
    """The stream may come from anywhere."""
    wanted = _picture_shape(shape)
    found = (stream.height, stream.width, stream.header.spec.channels)
    if found != (*wanted[:2], wanted[2] if len(wanted) == 3 else 1) or stream.dtype != dtype:
        raise CorruptStreamError(f"a chunk of {stream.dtype} {found}, where {dtype} {wanted} was to be")
