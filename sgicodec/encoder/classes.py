"""Maps of classes, labels and masks: pictures of few values, which are names and no amounts: none may change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.encoder.division import some_of
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual_form import Repeats, block_rects

__all__ = ["changed_bands", "holds_classes"]

_MAX_VALUES, _MAX_SCATTERED = 64, 16
"""Where most pixels are as the one to their left, and where not."""
_NEAR_LEVELS = 16
"""Within so many levels of 8 bits all values change at the usual quality. Scattered ones that lie farther apart may be
the grays of a scan."""
_LOOK_ROWS = 8
"""Of a block, which tell a photograph."""


def holds_classes(windows: Windows, plan: Plan) -> bool:
    """Whether a picture has so few values, of all channels together, and a layer can keep them."""
    if windows.shape.rounding:
        return False
    values, repeats = _no_values(windows), Repeats()
    for pixels in _blocks(windows, plan):
        for some in (pixels[:_LOOK_ROWS].reshape(-1, windows.shape.bands), pixels[repeats.see(pixels)]):
            values = _distinct(some, values)
            if len(values) > _MAX_VALUES:
                return False
    if plan.header.masked == "transparent" and not values[:, -1].any():
        return False  # it shows nothing
    if repeats.are_usual:
        return True
    extent = np.ptp(values[np.isfinite(values)]) if np.isfinite(values).any() else 0
    return len(values) <= _MAX_SCATTERED and (values.dtype != np.uint8 or bool(extent < _NEAR_LEVELS))


def changed_bands(windows: Windows, plan: Plan) -> list[int]:
    """Which bands without a meaning have few values, which change, from 1 on."""
    if plan.header.channels != "multi":
        return []
    left = {band: _no_values(windows)[:, :1] for band in range(windows.shape.bands)}
    for pixels in _blocks(windows, plan):
        for rows in (pixels[:_LOOK_ROWS], pixels):
            for band in list(left):
                left[band] = _distinct(rows[..., band].reshape(-1, 1), left[band])
                if len(left[band]) > _MAX_SCATTERED:
                    del left[band]
        if not left:
            break
    return [band + 1 for band, values in left.items() if not _is_kept(values, plan)]


def _is_kept(values: NDArray[Any], plan: Plan) -> bool:
    """Whether the only value of a band comes back."""
    return len(values) == 1 and (values.dtype != np.uint8 or values[0, 0] == plan.header.blank)


def _blocks(windows: Windows, plan: Plan) -> Iterator[NDArray[Any]]:
    """Pixels [h, w, C] of all blocks, and of some before, by which most pictures are told already."""
    rects = list(block_rects(plan.header))
    for rect in (*some_of(rects), *rects):
        yield windows.read(*rect).pixels


def _no_values(windows: Windows) -> NDArray[Any]:
    return np.zeros((0, windows.shape.bands), windows.shape.dtype)


def _distinct(pixels: NDArray[Any], known: NDArray[Any]) -> NDArray[Any]:
    """Values [n, C] of pixels and those that are known, each once; all that are no number are one."""
    values = np.concatenate([known, pixels])
    if pixels.shape[1] == 1:
        return np.unique(values)[:, None]
    return np.unique(np.nan_to_num(values, nan=np.inf) if values.dtype.kind == "f" else values, axis=0)
