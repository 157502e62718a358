"""Text, line art, screens and sharp alpha: a residual layer shows them instead of Gaussians and texture, at every
scale, because that takes fewer bits and keeps edges hard. And how good a picture is below a layer that shows all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sgicodec.bitstream.header import Header
from sgicodec.encoder.graphic_cells import CellSurvey, ColourSurvey, cell_means, cells_in, level_of, repeating_cells
from sgicodec.encoder.input.graphic_windows import with_fewer_colours, without_cells, without_unseen_colours
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual import Layer, bits_of_blocks
from sgicodec.encoder.residual_form import Repeats, block_rects
from sgicodec.metadata.layouts import alpha_index
from sgicodec.metrics.jpeg_grid import jpeg_grid, jpeg_saving
from sgicodec.metrics.psnr import luma
from sgicodec.model.steps import quality_index
from sgicodec.model.tile_grid import Rect

__all__ = ["Division", "with_graphics"]

_LARGE_LMBDA = 1e4
"""At which a model of one Gaussian is best."""
_MOST_BLOCKS = 12
"""By which a picture is judged."""
_LEAST_SHARE = 1 / 256
"""Of cells of a picture that are text or line art, where it has any."""
_EDGE_BITS, _EDGE_DOUBLING = 10.0, 40
"""Bits that a layer may take for a pixel of an edge at quality 50, and the steps of quality that double them: what a
lossy picture spends on text, or little more (docs/notes/2026-11-text.md).
"""
_SHARP_ALPHA = 0.375
"""Of the range, between neighbours that a sharp edge of alpha parts. Exact alpha may take as many bits for such a pixel
as a layer of text for one of an edge (docs/notes/2026-11-text.md)."""
_OTHER_BYTES = 150
"""Of a picture of which a layer shows all: headers, tables, tiles."""
_ERROR, _ERROR_HALVING = 8.0, 20
"""One more than the levels of 255 that colours may be off at quality 50, and the steps of quality that halve them."""
_MAX_ERROR = 15
"""Whatever the quality; text is often no more than twice as far from its ground."""
_MAX_COLOURS = 3
_JPEG_SHARE = 1 / 3
"""Of blocks of a picture that was a JPEG file in which its grid is seen: it is not where they are flat."""
_JPEG_QUALITY, _EXACT_ERROR, _ERROR_DOUBLING = 98.0, 2.0, 10.0
"""Quality below a layer over what was a JPEG file, up to which error in levels of 255, and by how much less it is for
each doubling of that (docs/notes/2026-11-residual-layer.md)."""


@dataclass(frozen=True)
class Division:
    """A picture divided in two: what tiles show, with their plan, and what a residual layer does, if there is one."""

    windows: Windows
    plan: Plan
    layer: Layer | None = None
    exact: ExactDivision | None = None
    """The picture without loss, where that may take fewer bytes."""


@dataclass(frozen=True)
class ExactDivision(Division):
    """A picture that a layer shows without loss, in all views. rects: some of its blocks, which stand for `parts` of
    it; least: bits that it takes at least.
    """

    rects: Sequence[Rect] = ()
    parts: float = 1.0
    least: float = 0.0

    def takes_less_than(self, size: int) -> bool:
        """Whether it takes fewer bytes, about."""
        bits = 8 * (size - _OTHER_BYTES)
        if self.layer is None or self.least >= bits:
            return False
        return bits_of_blocks(self.plan.header, self.layer, self.rects) / self.parts < bits


def with_graphics(windows: Windows, plan: Plan) -> Division:
    """What tiles show of a picture, and what a residual layer does. Where the layer was asked for, no quality of what
    is below was, and whole pixels repeat each other, it shows all, and of what was a JPEG file next to nothing; where
    nothing but a quality was asked for, text and line art. Else alpha is exact if that takes fewer bits. `exact` is
    there where most pixels repeat each other.
    """
    settings, header = plan.settings, plan.header
    asked = settings.max_error
    is_quality = "quality" in settings.chosen_profile.scales and settings.lmbda is None and settings.target is None
    rects = list(block_rects(header))
    sample = _some(rects)
    if asked is not None:
        return _below(windows, plan, asked, sample if is_quality and settings.quality is None else ())
    if not is_quality or not _may_have(header):
        return Division(windows, plan)
    if header.sample_type == "float32":
        return Division(windows, plan)
    seen = without_unseen_colours(windows)
    division = Division(windows, plan)
    if header.colours <= _MAX_COLOURS and _has_some(seen, sample):
        division = _divided(seen, plan, rects)
    if division.layer is None and alpha_index(header.channels) is not None and _is_alpha_cheap(windows, plan, sample):
        division = Division(windows, replace(plan, exact_alpha=True), Layer(windows, 0, is_alpha=True))
    repeats, parts = _repeats(seen, sample), len(sample) / len(rects)
    if not repeats.are_usual:
        return division
    layer = Layer(seen, 0, exact_views=True)
    return replace(
        division, exact=ExactDivision(seen, _above_nothing(plan), layer, None, sample, parts, repeats.others / parts)
    )


def _below(windows: Windows, plan: Plan, max_error: float, rects: Sequence[Rect]) -> Division:
    """A layer that was asked for and what is below it, judged by these blocks; none where its quality was asked for."""
    header, repeats = plan.header, Repeats()
    savings: list[float] = []  # of blocks of a JPEG file
    for rect in rects:
        pixels = windows.read(*rect).pixels
        repeats.see(pixels)
        plane = luma(pixels)
        if header.sample_type == "uint8" and (grid := jpeg_grid(plane)) is not None:
            savings.append(jpeg_saving(plane, grid))
    if header.spec.texture and len(savings) >= _JPEG_SHARE * len(rects) and sum(savings) > 0:
        return Division(windows, _nearly_exact(plan, max_error), Layer(windows, max_error))
    if _may_have(header) and repeats.are_usual:
        return Division(windows, _above_nothing(plan), Layer(windows, max_error, exact_views=True))
    return Division(windows, plan, Layer(windows, max_error))


def _repeats(windows: Windows, rects: Sequence[Rect]) -> Repeats:
    """How many pixels of these blocks are as the one to their left."""
    repeats = Repeats()
    for rect in rects:
        repeats.see(windows.read(*rect).pixels)
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
    layer = Layer(windows, 0, is_alpha=True)
    return is_soft and sharp > 0 and bits_of_blocks(plan.header, layer, sample) <= _edge_bits(plan) * sharp


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
    if alpha_index(header.channels) is not None:
        max_error = 0
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
    if bits_of_blocks(header, layer, judged) > _edge_bits(plan) * survey.edges(among):
        return Division(windows, plan)
    if cells.all():
        plan = replace(plan, settings=replace(plan.settings, max_error=max_error))
        return Division(windows, _above_nothing(plan), replace(layer, cells=None))
    return Division(without_cells(windows, cells, means), plan, layer)


def _edge_bits(plan: Plan) -> float:
    """Bits that a layer may take for a pixel of an edge."""
    return float(_EDGE_BITS * 2 ** ((plan.settings.chosen_quality - 50) / _EDGE_DOUBLING))


def _above_nothing(plan: Plan) -> Plan:
    """The plan of tiles that take next to nothing."""
    settings, header = replace(plan.settings, effort=1, steps=None), replace(plan.header, masked=None)
    return replace(plan, settings=settings, header=header).at(_LARGE_LMBDA, quality_index(_LARGE_LMBDA))


def _nearly_exact(plan: Plan, max_error: float) -> Plan:
    """The plan of tiles that show what was a JPEG file so well that a layer has little to add to any sample."""
    less = _ERROR_DOUBLING * math.log2(max(max_error, _EXACT_ERROR) / _EXACT_ERROR)
    lmbda = replace(plan.settings, quality=max(1.0, _JPEG_QUALITY - less)).fit_settings().lmbda
    return plan.at(lmbda, quality_index(lmbda))


def _may_have(header: Header) -> bool:
    """Whether all samples of a picture are numbers that are seen, but for colours without alpha."""
    return header.masked != "nodata" and not header.has_exact


def _some(rects: Sequence[Rect]) -> Sequence[Rect]:
    return rects[:: -(-len(rects) // _MOST_BLOCKS) or 1]


def _has_some(windows: Windows, sample: Sequence[Rect]) -> bool:
    """Whether enough cells of blocks of a picture repeat themselves as text does to look at all."""
    repeat = [repeating_cells(windows.read(*rect).pixels) for rect in sample]
    return sum(int(cells.sum()) for cells in repeat) >= _LEAST_SHARE * sum(cells.size for cells in repeat)
