"""How good a picture is below a residual layer that shows all of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from sgicodec.bitstream.header import Header
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual.blocks import Repeats, judged_rects
from sgicodec.encoder.residual.division import Division, has_all_samples, nearly_empty_tiles
from sgicodec.encoder.residual.graphic_windows import without_unseen_colours
from sgicodec.encoder.residual.layer import ResidualLayer
from sgicodec.metrics.jpeg_grid import jpeg_grid, jpeg_saving
from sgicodec.metrics.psnr import luma
from sgicodec.model.tile_grid import Rect
from sgicodec.picture import nodata_samples

_JPEG_SHARE = 1 / 3
"""Of blocks of a picture that was a JPEG file in which its grid is seen: it is not where they are flat."""
_JPEG_QUALITY, _EXACT_ERROR, _ERROR_DOUBLING = 98.0, 2.0, 10.0
"""Quality below a layer over what was a JPEG file, up to which error in levels of 255, and by how much less it is for
each doubling of that (docs/notes/2026-11-residual-layer.md)."""
_QUALITY_BELOW = 20.0
"""Of a picture of which a layer cannot show all views, where nothing was asked for: they matter little."""


def without_loss(windows: Windows, plan: Plan) -> Division:
    """All samples as they are, but for what 32 bits of them lack, in every view where none is nodata."""
    settings = replace(plan.settings, max_error=0.0)
    plan = replace(plan, settings=settings)
    if has_all_samples(plan.header):
        seen = without_unseen_colours(windows)
        return Division(seen, nearly_empty_tiles(plan), ResidualLayer.exact(seen, exact_views=True))
    if settings.quality is None:
        usual = replace(settings, quality=_QUALITY_BELOW).fit_settings().lmbda
        plan = plan.at(usual * _span(windows, plan.header) ** 2)
    return Division(windows, plan, ResidualLayer.exact(windows))


def _span(windows: Windows, header: Header) -> float:
    """The range of samples of some blocks, nodata aside, in parts of what quality spans: classes of 8 bits may be near
    each other.
    """
    if header.sample_type != "uint8":
        return 1.0
    low, high = 255, 0
    for rect in judged_rects(header):
        window = windows.read(*rect)
        samples = window.pixels[..., : window.alpha][~nodata_samples(window)]
        low, high = int(samples.min(initial=low)), int(samples.max(initial=high))
    return max(1, high - low) / 255


def with_layer(windows: Windows, plan: Plan) -> Division:
    """A layer with the error that is asked for, and what is below it. Where no quality is, the layer shows all if whole
    pixels repeat each other, and next to nothing of what was a JPEG file.
    """
    header, max_error, repeats = plan.header, plan.settings.max_error or 0.0, Repeats()
    is_free = plan.settings.is_quality_asked and plan.settings.quality is None
    rects: Sequence[Rect] = judged_rects(header) if is_free else ()
    savings: list[float] = []  # of blocks of a JPEG file
    for rect in rects:
        pixels = windows.read(*rect).pixels
        repeats.see(pixels)
        plane = luma(pixels)
        if header.sample_type == "uint8" and (grid := jpeg_grid(plane)) is not None:
            savings.append(jpeg_saving(plane, grid))
    if header.spec.texture and len(savings) >= _JPEG_SHARE * len(rects) and sum(savings) > 0:
        return Division(windows, _nearly_exact(plan, max_error), ResidualLayer(windows, max_error))
    if has_all_samples(header) and repeats.are_usual:
        return Division(windows, nearly_empty_tiles(plan), ResidualLayer(windows, max_error, exact_views=True))
    return Division(windows, plan, ResidualLayer(windows, max_error))


def _nearly_exact(plan: Plan, max_error: float) -> Plan:
    """The plan of tiles that show what was a JPEG file so well that a layer has little to add to any sample."""
    less = _ERROR_DOUBLING * math.log2(max(max_error, _EXACT_ERROR) / _EXACT_ERROR)
    return plan.at(replace(plan.settings, quality=max(1.0, _JPEG_QUALITY - less)).fit_settings().lmbda)
