"""Text, line art, screens and sharp alpha: a residual layer shows them instead of Gaussians and texture, at every
scale, because that takes fewer bits and keeps edges hard.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual.below_layer import without_loss
from sgicodec.encoder.residual.blocks import Repeats, block_rects, some_of
from sgicodec.encoder.residual.division import Division, ExactDivision, has_all_samples, nearly_empty_tiles
from sgicodec.encoder.residual.graphic_cells import (
    CellSurvey,
    ColourSurvey,
    cell_means,
    cells_in,
    level_of,
    repeating_cells,
)
from sgicodec.encoder.residual.graphic_windows import with_fewer_colours, without_cells, without_unseen_colours
from sgicodec.encoder.residual.layer import ResidualLayer, bits_of_blocks
from sgicodec.metadata.layouts import alpha_index
from sgicodec.model.tile_grid import Rect
from sgicodec.picture import nodata_samples
from sgicodec.profiles.default import DEFAULT_QUALITY

_MIN_SHARE = 1 / 256
"""Of cells of a picture that are text or line art, where it has any."""
_EDGE_BITS, _EDGE_DOUBLING = 10.0, 40
"""Bits that a layer may take for a pixel of an edge at quality 50, and the steps of quality that double them: what a
lossy picture spends on text, or little more (docs/notes/2026-11-text.md).
"""
_SHARP_ALPHA = 0.375
"""Of the range, between neighbours that a sharp edge of alpha parts. Exact alpha may take as many bits for such a pixel
as a layer of text for one of an edge (docs/notes/2026-11-text.md)."""
_ERROR, _ERROR_HALVING = 8.0, 20
"""One more than the levels of 255 that colours may be off at quality 50, and the steps of quality that halve them."""
_MAX_ERROR = 15
"""Whatever the quality; text is often no more than twice as far from its ground."""
_MAX_COLOURS = 3
_WORTH_OF_DATA = 1.5
"""Times the bytes of a lossy stream that one without loss may take where most pixels repeat each other and samples are
no 8 bits to look at: then they are the numbers of areas (docs/notes/2026-11-text.md)."""


def with_graphics(windows: Windows, plan: Plan) -> Division:
    """What tiles show of a picture, and what a residual layer does: text and line art; else alpha, if that takes fewer
    bits without loss. `exact` is there where most pixels repeat each other.
    """
    header = plan.header
    division, rects = Division(windows, plan), list(block_rects(header))
    seen, sample = without_unseen_colours(windows), some_of(rects)
    if has_all_samples(header) and header.sample_type != "float32":
        if header.colours <= _MAX_COLOURS and _has_some(seen, sample):
            division = _divided(seen, plan, rects)
        has_alpha = division.layer is None and alpha_index(header.channels) is not None
        if has_alpha and _is_alpha_cheap(windows, plan, sample):
            division = Division(windows, replace(plan, exact_alpha=True), ResidualLayer(windows, 0, is_alpha=True))
    return replace(division, exact=exact_instead(windows, plan))


def exact_instead(windows: Windows, plan: Plan) -> ExactDivision | None:
    """The picture without loss, where most pixels repeat each other."""
    header, rects = plan.header, list(block_rects(plan.header))
    sample = some_of(rects)
    repeats, parts = _repeats(without_unseen_colours(windows), sample), len(sample) / len(rects)
    if not repeats.are_usual or windows.shape.rounding:
        return None
    worth = 1.0 if has_all_samples(header) and header.sample_type == "uint8" else _WORTH_OF_DATA
    return ExactDivision(without_loss(windows, plan), sample, parts, repeats.others / parts, worth)


def _repeats(windows: Windows, rects: Sequence[Rect]) -> Repeats:
    """How many pixels of these blocks are as the one to their left, without those of nodata."""
    repeats = Repeats()
    for rect in rects:
        window = windows.read(*rect)
        seen = None if window.nodata is None else np.asarray(~nodata_samples(window).all(axis=2))
        repeats.see(window.pixels, seen)
    return repeats


def _is_alpha_cheap(windows: Windows, plan: Plan, sample: Sequence[Rect]) -> bool:
    """Whether exact alpha takes fewer bits than its sharp edges alone do in a model. Where all of it is 0 or opaque, a
    mask says the same.
    """
    opaque, sharp, is_soft = np.iinfo(plan.header.sample_type).max, 0, False
    for rect in sample:
        alpha = windows.read(*rect).pixels[..., -1].astype(np.int32)
        across, down = (np.abs(np.diff(alpha, axis=axis)) >= _SHARP_ALPHA * opaque for axis in (1, 0))
        sharp += int(np.count_nonzero(across[:-1] | down[:, :-1]))
        is_soft = is_soft or bool(((alpha > 0) & (alpha < opaque)).any())
    layer = ResidualLayer(windows, 0, is_alpha=True)
    return is_soft and sharp > 0 and bits_of_blocks(plan.header, layer, sample) <= _edge_bits(plan) * sharp


def _divided(windows: Windows, plan: Plan, rects: Sequence[Rect]) -> Division:
    header, survey = plan.header, CellSurvey(plan.header)
    for rect in rects:
        survey.see(rect, windows.read(*rect).pixels)
    cells = survey.graphic()
    if cells.mean() < _MIN_SHARE:
        return Division(windows, plan)
    above = plan.settings.chosen_quality - DEFAULT_QUALITY
    off = _ERROR * 2 ** (-above / _ERROR_HALVING) - 1
    max_error = int(min(_MAX_ERROR, max(0.0, off)) * level_of(header))
    if alpha_index(header.channels) is not None:
        max_error = 0
    colours, means = ColourSurvey(header), np.zeros((*cells.shape, header.spec.channels), np.float32)
    for rect in rects:
        pixels = windows.read(*rect).pixels
        colours.see(pixels, cells[cells_in(rect)])
        means[cells_in(rect)] = cell_means(pixels)
    shown, max_error = with_fewer_colours(windows, cells, colours.counts, max_error)
    layer = ResidualLayer(shown, max_error, exact_views=True, cells=cells, includes_error=True)
    judged = some_of([rect for rect in rects if cells[cells_in(rect)].any()])
    among = np.zeros_like(cells)
    for rect in judged:
        among[cells_in(rect)] = cells[cells_in(rect)]
    if bits_of_blocks(header, layer, judged) > _edge_bits(plan) * survey.edges(among):
        return Division(windows, plan)
    if cells.all():
        plan = replace(plan, settings=replace(plan.settings, max_error=max_error))
        return Division(windows, nearly_empty_tiles(plan), replace(layer, cells=None))
    return Division(without_cells(windows, cells, means), plan, layer)


def _edge_bits(plan: Plan) -> float:
    """Bits that a layer may take for a pixel of an edge."""
    return float(_EDGE_BITS * 2 ** ((plan.settings.chosen_quality - DEFAULT_QUALITY) / _EDGE_DOUBLING))


def _has_some(windows: Windows, sample: Sequence[Rect]) -> bool:
    """Whether enough cells of blocks of a picture repeat themselves as text does to look at all."""
    repeat = [repeating_cells(windows.read(*rect).pixels) for rect in sample]
    return sum(int(cells.sum()) for cells in repeat) >= _MIN_SHARE * sum(cells.size for cells in repeat)
