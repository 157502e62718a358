"""Indices as of an array, as the region of the picture that holds what they name."""

from __future__ import annotations

from types import EllipsisType
from typing import Any

from sgicodec.decoder.view import Region
from sgicodec.errors import RegionError, UsageError


def indexed_region(key: Any, shape: tuple[int, ...]) -> tuple[Region, tuple[int | slice, ...]]:
    """The region (x, y, width, height) that `key` touches in an array of `shape`, [H, W] or [H, W, C], and the index
    that takes from it what `key` names. A region without pixels has a width or a height of 0.

    Raises RegionError, an IndexError too, for an integer outside, UsageError for what is no integer or slice.
    """
    indices = [slice(None)] * len(shape)
    for axis, index in _by_axis(key, len(shape)):
        indices[axis] = index
    spans, inner = zip(*(_span(index, size) for index, size in zip(indices, shape, strict=True)), strict=True)
    (top, bottom), (left, right) = spans[:2]
    channel = (indices[2],) if len(shape) > 2 else ()
    return (left, top, right - left, bottom - top), (*inner[:2], *channel)


def _by_axis(key: Any, axes: int) -> list[tuple[int, Any]]:
    keys = key if isinstance(key, tuple) else (key,)
    gaps = [position for position, index in enumerate(keys) if isinstance(index, EllipsisType)]
    if len(gaps) > 1 or len(keys) - len(gaps) > axes:
        raise RegionError(f"{len(keys)} indices into {axes} axes")
    gap = gaps[0] if gaps else len(keys)
    behind = keys[gap + 1 :]
    return [*enumerate(keys[:gap]), *enumerate(behind, axes - len(behind))]


def _span(index: Any, size: int) -> tuple[tuple[int, int], int | slice]:
    """First and last one and on that `index` touches of an axis, and the index into these."""
    if isinstance(index, bool) or not (isinstance(index, slice) or hasattr(index, "__index__")):
        raise UsageError(f"an index {index!r}; streams take integers and slices: np.asarray(stream) takes all others")
    try:
        found = range(size)[index]
    except IndexError:
        raise RegionError(f"index {index} is outside an axis of {size}") from None
    except (TypeError, ValueError) as error:
        raise UsageError(f"index {index}: {error}") from error
    if isinstance(found, int):
        return (found, found + 1), 0
    if not found:
        return (0, 0), slice(0, 0)
    first, last = min(found[0], found[-1]), max(found[0], found[-1])
    return (first, last + 1), slice(found[0] - first, None, found.step)
