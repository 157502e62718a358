"""Where a picture lies after it was turned, cut or scaled: the tags that tie pixels to places, for the new pixels.

Raster coordinates count from the outer corner of the first pixel, x to the right and y down. Tags count from its centre
instead if the file says so (GTRasterTypeGeoKey 2, "PixelIsPoint"), and rational polynomials always do.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.arrays import F64
from sgicodec.metadata import geo, ifd
from sgicodec.metadata.motion import scaled_ratio
from sgicodec.metadata.orientation import is_flipped, is_mirrored, is_sideways

_DOUBLE, _RATIONAL = 12, 5
_RASTER_TYPE, _IS_POINT = 1025, 2
_RPC_VALUES, _RPC_OFFSETS, _RPC_SCALES = 92, [3, 2], [8, 7]
"""Number of a rational polynomial's values, and where the offsets and scales of x and y are among them."""

_X_RESOLUTION, _Y_RESOLUTION = 282, 283
_CENTRE = np.array([[1.0, 0.0, -0.5], [0.0, 1.0, -0.5], [0.0, 0.0, 1.0]])
"""From coordinates that count from the corner to those that count from the centre."""


def oriented(blob: bytes | None, orientation: int, width: int, height: int) -> bytes | None:
    """The blob for a picture of width × height stored pixels after `orientation` was applied."""
    move = np.eye(3)
    if is_sideways(orientation):
        move = move[[1, 0, 2]]
        width, height = height, width
    if is_mirrored(orientation):
        move = np.array([[-1.0, 0.0, width], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) @ move
    if is_flipped(orientation):
        move = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, height], [0.0, 0.0, 1.0]]) @ move
    return _moved(blob, move)


def view(blob: bytes | None, x: float, y: float, scale_x: float = 1.0, scale_y: float = 1.0) -> bytes | None:
    """The blob for the region whose corner is (x, y), in scale_x × scale_y pixels for each of the picture's."""
    return _moved(blob, np.array([[scale_x, 0.0, -x * scale_x], [0.0, scale_y, -y * scale_y], [0.0, 0.0, 1.0]]))


def transformation(blob: bytes | None) -> F64 | None:
    """From raster coordinates of pixel corners (x, y, 1) to coordinates of the map [2, 3]; None where no pixel scale
    with a tie point, and no transformation, says so.
    """
    entries = geo.load(blob)
    scale, ties = _doubles(entries.get(geo.PIXEL_SCALE), 3), _doubles(entries.get(geo.TIEPOINTS), -1, 6)
    matrix = _doubles(entries.get(geo.MATRIX), 4, 4)
    if matrix is None and scale is not None and ties is not None and len(ties):
        matrix = _as_matrix(scale, ties[0])
    if matrix is None or not np.isfinite(matrix).all():
        return None
    plane = matrix[:2][:, [0, 1, 3]]
    return plane @ _CENTRE if _is_point(entries) else plane


def _moved(blob: bytes | None, move: F64) -> bytes | None:
    """The blob after pixels went from raster coordinates p to move @ p, with `move` [3, 3] affine."""
    if np.array_equal(move, np.eye(3)):
        return blob
    entries = geo.load(blob)
    from_tags = _CENTRE @ move @ np.linalg.inv(_CENTRE) if _is_point(entries) else move
    straight = not move[[0, 1], [1, 0]].any() and (np.diag(move) > 0).all()
    scale, ties = _doubles(entries.pop(geo.PIXEL_SCALE, None), 3), _doubles(entries.pop(geo.TIEPOINTS, None), -1, 6)
    matrix, rpc = _doubles(entries.pop(geo.MATRIX, None), 4, 4), _doubles(entries.pop(geo.RPC, None), _RPC_VALUES)
    if scale is not None and ties is not None and not straight:
        matrix, scale, ties = _as_matrix(scale, ties[0]), None, None
    if scale is not None:
        entries[geo.PIXEL_SCALE] = _entry(scale / np.diag(move))
    if ties is not None:
        ties[:, :2] = ties[:, :2] @ from_tags[:2, :2].T + from_tags[:2, 2]
        entries[geo.TIEPOINTS] = _entry(ties)
    if matrix is not None:
        matrix[:, [0, 1, 3]] = matrix[:, [0, 1, 3]] @ np.linalg.inv(from_tags)
        entries[geo.MATRIX] = _entry(matrix)
    if rpc is not None and straight:
        centred = _CENTRE @ move @ np.linalg.inv(_CENTRE)
        rpc[_RPC_OFFSETS] = centred[:2, :2] @ rpc[_RPC_OFFSETS] + centred[:2, 2]
        rpc[_RPC_SCALES] *= np.diag(move)[:2]
        entries[geo.RPC] = _entry(rpc)
    return geo.pack({**entries, **_resolution(entries, np.abs(move[:2, :2]))})


def _is_point(entries: dict[int, ifd.Entry]) -> bool:
    data = entries[geo.KEYS].data if geo.KEYS in entries else b""
    keys = np.frombuffer(data[: len(data) // 8 * 8], "<u2").reshape(-1, 4)[1:]
    return any(key == _RASTER_TYPE and value == _IS_POINT for key, _, _, value in keys)


def _doubles(entry: ifd.Entry | None, *shape: int) -> F64 | None:
    """A tag's values in this shape, whose -1 is any number; None for what is no such tag."""
    if entry is None or entry.kind != _DOUBLE:
        return None
    values = np.frombuffer(entry.data, "<f8").astype(np.float64)
    try:
        return values.reshape(shape)
    except ValueError:
        return None


def _entry(values: npt.NDArray[Any]) -> ifd.Entry:
    return ifd.Entry(_DOUBLE, values.astype("<f8").tobytes())


def _as_matrix(scale: F64, tie: F64) -> F64:
    """The transformation [4, 4] that a pixel scale and a tie point stand for: y of the model goes up."""
    step = scale * (1.0, -1.0, 1.0)
    return np.vstack([np.column_stack([np.diag(step), tie[3:] - step * tie[:3]]), [0.0, 0.0, 0.0, 1.0]])


def _resolution(entries: dict[int, ifd.Entry], scale: F64) -> dict[int, ifd.Entry]:
    """Pixels per unit, scaled by `scale` [2, 2] where new x and y come from old x and y."""
    old = [entries.get(tag) for tag in (_X_RESOLUTION, _Y_RESOLUTION)]
    new: dict[int, ifd.Entry] = {}
    for tag, factors in zip((_X_RESOLUTION, _Y_RESOLUTION), scale.tolist(), strict=True):
        for entry, factor in zip(old, factors, strict=True):
            if entry is not None and factor and entry.kind == _RATIONAL and len(entry.data) == 8:
                above, below = struct.unpack("<II", entry.data)
                new[tag] = ifd.Entry(_RATIONAL, struct.pack("<II", *scaled_ratio(above, below, factor)))
    return new
