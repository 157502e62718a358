"""Maps of classes, labels and masks, and bands of them: few values, which are names and no amounts: none may change."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual.blocks import DistinctPixels, Repeats, block_rects, judged_rects
from sgicodec.metadata import geo
from sgicodec.metadata.layouts import alpha_index, band_ranges
from sgicodec.picture import nodata_samples

_MAX_VALUES, _MAX_SCATTERED = 64, 16
"""Where most pixels are as the one to their left, and where not."""
_NEAR_LEVELS = 16
"""Within so many levels of 8 bits all values change at the usual quality. Scattered ones that lie farther apart may be
the grays of a scan, but of a map."""
_MIN_RUN = 8
"""Pixels. Samples that were enlarged have shorter ones."""
_ONE_VALUE = 1e-6
"""Parts of a sample that the range of a single value spans at most."""
_LOOK_ROWS = 8
"""Of a block, which tell a photograph."""


def bands_of_classes(windows: Windows, plan: Plan) -> tuple[int, ...]:
    """Which channels hold classes, from 0 on: all where they have few values together, and a layer can keep them; else
    bands without a meaning that have few by themselves, and may change, or numbers of areas. On a map the former may be
    colours: GDAL calls three bands of 8 bits red, green and blue.
    """
    if windows.shape.is_clipped:
        return ()
    if _holds_classes(windows, plan):
        return tuple(range(windows.shape.bands))
    if plan.header.channels != "multi" and not (plan.header.channels == "rgb" and _is_map(windows, plan)):
        return ()
    left = {band: (DistinctPixels(_MAX_VALUES), Repeats()) for band in range(windows.shape.bands)}
    for pixels in _blocks(windows, plan):
        bands = ((band, pixels[..., band, None]) for band in left)
        left = {band: left[band] for band, seen in bands if _are_few(left[band][0], seen, left[band][1].see(seen))}
        if not left:
            break
    few = {band for band, (values, repeats) in left.items() if _may_change(values.known, repeats, plan)}
    return tuple(sorted(few | _labelled_bands(windows, plan)))


def _holds_classes(windows: Windows, plan: Plan) -> bool:
    values, repeats = DistinctPixels(_MAX_VALUES), Repeats()
    for pixels in _blocks(windows, plan):
        if not _are_few(values, pixels, repeats.see(pixels)):
            return False
    if plan.header.masked == "transparent" and not values.known[:, -1].any():
        return False  # it shows nothing
    if repeats.are_usual:
        return True
    is_near = values.known.dtype != np.uint8 or bool(np.ptp(values.known) < _NEAR_LEVELS) or _is_map(windows, plan)
    return len(values.known) <= _MAX_SCATTERED and is_near


def _labelled_bands(windows: Windows, plan: Plan) -> set[int]:
    """Which bands without a meaning have runs of equal values that are not 0, as numbers of areas have."""
    if plan.header.channels != "multi":
        return set()
    runs = [(Repeats(), DistinctPixels(1)) for _ in range(windows.shape.bands)]
    for rect in judged_rects(plan.header):
        window = windows.read(*rect)
        is_label = (window.pixels != 0) & ~nodata_samples(window)
        for band, (repeats, values) in enumerate(runs):
            repeats.see(window.pixels[..., band, None], is_label[..., band])
            values.see(window.pixels[is_label[..., band], band, None])
    return {
        band
        for band, (seen, values) in enumerate(runs)
        if len(values.known) > 1 and _MIN_RUN * seen.others < seen.pixels
    }


def lost_bands(plan: Plan, max_error: float) -> list[int]:
    """Which colours or bands an error may make a single value, from 0 on, but for those that are one."""
    header, colours = plan.header, plan.header.spec.channels - (alpha_index(plan.header.channels) is not None)
    ranges = enumerate(band_ranges(header.sample_range, colours))
    is_float = header.sample_type == "float32"
    return [
        band
        for band, (low, high) in ranges
        if (_ONE_VALUE * abs(high) if is_float else 1) < high - low <= 2 * max_error
    ]


def _is_map(windows: Windows, plan: Plan) -> bool:
    """Whether samples are data of a place, or of one that lacks some."""
    return plan.header.masked == "nodata" or geo.has_place(windows.shape.metadata.geo)


def _may_change(values: NDArray[Any], repeats: Repeats, plan: Plan) -> bool:
    """Whether the values of a band are classes. A single one comes back anyhow where it is the end of a range."""
    if len(values) == 1:
        return bool(values.dtype == np.uint8 and values[0, 0] != plan.header.blank)
    return len(values) <= _MAX_SCATTERED or repeats.are_usual


def _blocks(windows: Windows, plan: Plan) -> Iterator[NDArray[Any]]:
    """Pixels [h, w, C] of all blocks, those first by which most pictures are told already."""
    first = judged_rects(plan.header)
    for rect in (*first, *(rect for rect in block_rects(plan.header) if rect not in first)):
        yield windows.read(*rect).pixels


def _are_few(values: DistinctPixels, pixels: NDArray[Any], others: Any) -> bool:
    """Whether the values are few with these pixels [h, w, C] of a block, too, of which `others` are enough to know."""
    channels = pixels.shape[2]
    return values.see(pixels[:_LOOK_ROWS].reshape(-1, channels)) and values.see(pixels[others].reshape(-1, channels))
