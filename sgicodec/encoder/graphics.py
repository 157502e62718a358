"""Text, line art and screens: a residual layer shows them instead of Gaussians and texture, at every scale, because
that takes fewer bits and keeps edges hard.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sgicodec.bitstream.header import Header
from sgicodec.encoder.graphic_cells import CellSurvey, ColourSurvey, cell_means, cells_in, level_of, repeating_cells
from sgicodec.encoder.input.graphic_windows import with_fewer_colours, without_cells
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual import Layer, bits_of_blocks
from sgicodec.encoder.residual_grids import Repeats, block_rects
from sgicodec.metadata.layouts import alpha_index
from sgicodec.model.steps import quality_index
from sgicodec.model.tile_grid import Rect

__all__ = ["Division", "with_graphics"]

_LARGE_LMBDA = 1e4
"""At which a model of one Gaussian is best."""
_LOW_QUALITY = 20.0
"""Of what a layer with alpha shows in the picture's own pixels alone: other views are of the tiles. Two logos take 12 and
30 % fewer bytes than with 50 (docs/notes/2026-11-text.md)."""
_MOST_BLOCKS = 12
"""By which a picture is judged."""
_LEAST_SHARE = 1 / 256
"""Of cells of a picture that are text or line art, where it has any."""
_EDGE_BITS, _EDGE_DOUBLING = 10.0, 40
"""Bits that a layer may take for a pixel of an edge at quality 50, and the steps of quality that double them: what a
lossy picture spends on text, or little more (docs/notes/2026-11-text.md).
"""
_ERROR, _ERROR_HALVING = 8.0, 20
"""One more than the levels of 255 that colours may be off at quality 50, and the steps of quality that halve them."""
_MAX_ERROR = 15
"""Whatever the quality; text is often no more than twice as far from its ground."""
_MAX_CHANNELS = 3


class Division(NamedTuple):
    """A picture divided in two: what tiles show, with their plan, and what a residual layer does, if there is one."""

    windows: Windows
    plan: Plan
    layer: Layer | None = None


def with_graphics(windows: Windows, plan: Plan) -> Division:
    """What tiles show of a picture, and what a residual layer does. Where the layer was asked for, no quality of what
    is below was, and whole pixels repeat each other, it shows all, or tiles show little where there is alpha; where
    nothing but a quality was asked for, it shows text and line art.
    """
    settings, header = plan.settings, plan.header
    asked = settings.max_error
    is_quality = "quality" in settings.chosen_profile.scales and settings.lmbda is None and settings.target is None
    is_below_asked = asked is not None and settings.quality is not None
    has_alpha = alpha_index(header.channels) is not None
    if not is_quality or is_below_asked or not (_may_have(header) or asked is not None and has_alpha):
        return Division(windows, plan, None if asked is None else Layer(windows, asked))
    rects = list(block_rects(header))
    sample = _some(rects)
    if asked is not None:
        repeats = Repeats()
        for rect in sample:
            repeats.see(windows.read(*rect).pixels)
        if not repeats.are_usual:
            return Division(windows, plan, Layer(windows, asked))
        if has_alpha:
            return Division(windows, _small(plan, _quality_lmbda(plan, _LOW_QUALITY)), Layer(windows, asked))
        return Division(windows, _small(plan, _LARGE_LMBDA), Layer(windows, asked, exact_views=True))
    if header.sample_type == "float32" or header.spec.channels > _MAX_CHANNELS or not _has_some(windows, sample):
        return Division(windows, plan)
    return _divided(windows, plan, rects)


def _divided(windows: Windows, plan: Plan, rects: Sequence[Rect]) -> Division:
    header, survey = plan.header, CellSurvey(plan.header)
    for rect in rects:
        survey.see(rect, windows.read(*rect).pixels)
    cells = survey.graphic()
    if cells.mean() < _LEAST_SHARE:
        return Division(windows, plan)
    above = plan.settings.chosen_quality - 50
    off = _ERROR * 2 ** (-above / _ERROR_HALVING) - 1
    max_error = int(min(_MAX_ERROR, max(0.0, off)) * level_of(header))
    colours, means = ColourSurvey(header), np.zeros((*cells.shape, header.spec.channels), np.float32)
    for rect in rects:
        pixels = windows.read(*rect).pixels
        colours.see(pixels, cells[cells_in(rect)])
        means[cells_in(rect)] = cell_means(pixels)
    shown, max_error = with_fewer_colours(windows, cells, colours.counts, max_error)
    layer = Layer(shown, max_error, exact_views=True, cells=cells, is_off=True)
    judged = _some([rect for rect in rects if cells[cells_in(rect)].any()])
    among = np.zeros_like(cells)
    for rect in judged:
        among[cells_in(rect)] = cells[cells_in(rect)]
    if bits_of_blocks(header, layer, judged) > _EDGE_BITS * 2 ** (above / _EDGE_DOUBLING) * survey.edges(among):
        return Division(windows, plan)
    if cells.all():
        plan = replace(plan, settings=replace(plan.settings, max_error=max_error))
        return Division(windows, _small(plan, _LARGE_LMBDA), replace(layer, cells=None))
    return Division(without_cells(windows, cells, means), plan, layer)


def _small(plan: Plan, lmbda: float) -> Plan:
    """The plan of tiles of which a layer shows all."""
    plan = replace(plan, settings=replace(plan.settings, effort=1, steps=None))
    return plan.at(lmbda, quality_index(lmbda))


def _quality_lmbda(plan: Plan, quality: float) -> float:
    return replace(plan.settings, quality=quality).fit_settings().lmbda


def _may_have(header: Header) -> bool:
    """Whether all samples of a picture count alike."""
    return header.masked is None and not header.has_exact and alpha_index(header.channels) is None


def _some(rects: Sequence[Rect]) -> Sequence[Rect]:
    return rects[:: -(-len(rects) // _MOST_BLOCKS) or 1]


def _has_some(windows: Windows, sample: Sequence[Rect]) -> bool:
    """Whether enough cells of blocks of a picture repeat themselves as text does to look at all."""
    repeat = [repeating_cells(windows.read(*rect).pixels) for rect in sample]
    return sum(int(cells.sum()) for cells in repeat) >= _LEAST_SHARE * sum(cells.size for cells in repeat)
