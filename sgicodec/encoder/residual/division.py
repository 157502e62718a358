"""What tiles show of a picture, and what a residual layer does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sgicodec.bitstream.header import Header
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual.layer import ResidualLayer, bits_of_blocks
from sgicodec.model.tile_grid import Rect

_LARGE_LMBDA = 1e4
"""At which a model of one Gaussian is best."""
_OTHER_BYTES = 150
"""Of a picture of which a layer shows all: headers, tables, tiles."""


@dataclass(frozen=True)
class Division:
    """A picture divided in two: what tiles show, with their plan, and what a residual layer does, if there is one."""

    windows: Windows
    plan: Plan
    layer: ResidualLayer | None = None
    exact: ExactDivision | None = None
    """The picture without loss, where that may take fewer bytes."""


@dataclass(frozen=True)
class ExactDivision:
    """A picture without loss. rects: some of its blocks, which stand for `parts` of it; least: bits that it takes at
    least; worth: how many times the bytes of a lossy stream it may take.
    """

    division: Division
    rects: Sequence[Rect]
    parts: float
    least: float
    worth: float

    def may_be_taken(self, size: int) -> bool:
        """Whether its layer takes few enough bytes, about, where a lossy stream takes so many."""
        layer, bits = self.division.layer, 8 * (self.worth * size - _OTHER_BYTES)
        if layer is None or self.least >= bits:
            return False
        return bits_of_blocks(self.division.plan.header, layer, self.rects) / self.parts < bits


def has_all_samples(header: Header) -> bool:
    """Whether all samples of a picture are numbers that are seen, but for colours without alpha."""
    return header.masked != "nodata" and not header.has_exact


def nearly_empty_tiles(plan: Plan) -> Plan:
    """The plan of tiles that take next to nothing."""
    settings, header = replace(plan.settings, effort=1, steps=None), replace(plan.header, masked=None)
    plan = replace(plan, settings=settings, header=header, texture_lmbda=None)
    return plan.at(_LARGE_LMBDA)
