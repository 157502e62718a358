"""Text, line art and screens: which pictures are coded without loss because that takes no more, and are shown by exact
pixels at every scale.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.residual_grids import Repeats, block_rects, residual_form
from sgicodec.metadata.layouts import alpha_index
from sgicodec.model.steps import quality_index

__all__ = ["with_exact_views"]

_LARGE_LMBDA = 1e4
"""At which a model of one Gaussian is best."""
_MOST_BLOCKS = 12
"""By which a picture is judged."""
_USUAL_BITS, _DOUBLING = 0.8, 20
"""Bits of a pixel of text at quality 50, with loss, and the steps of quality that double them."""


def with_exact_views(windows: Windows, plan: Plan) -> Plan:
    """The plan of a lossless stream over a lossy picture that takes next to nothing, where whole pixels repeat each
    other: if a residual layer is asked for, but no quality of what is below; or if neither is, and the layer will
    probably take no more than a lossy stream of this quality.
    """
    settings = plan.settings
    is_quality = "quality" in settings.chosen_profile.scales and settings.lmbda is None and settings.target is None
    is_below_asked = settings.max_error is not None and settings.quality is not None
    if not is_quality or is_below_asked or not _may_have(plan.header):
        return plan
    rects = list(block_rects(plan.header))
    rects = rects[:: -(-len(rects) // _MOST_BLOCKS)]
    blocks, repeats = [windows.read(*rect).pixels for rect in rects], Repeats()
    for block in blocks:
        repeats.see(block)
    if not repeats.are_usual:
        return plan
    if settings.max_error is None:
        limit = _USUAL_BITS * 2 ** ((settings.chosen_quality - 50) / _DOUBLING)
        if _bits_of_pixel(plan.header, blocks) > limit:
            return plan
        settings = replace(settings, max_error=0)
    plan = replace(plan, settings=replace(settings, effort=1, steps=None), exact_views=True)
    return plan.at(_LARGE_LMBDA, quality_index(_LARGE_LMBDA))


def _may_have(header: Header) -> bool:
    """Whether all samples of a picture count alike."""
    return header.masked is None and not header.has_exact and alpha_index(header.channels) is None


def _bits_of_pixel(header: Header, blocks: Iterable[NDArray[Any]]) -> float:
    """What a residual layer takes of these blocks, without loss and whatever is drawn below."""
    blocks = [np.ascontiguousarray(block, np.float32) for block in blocks]
    form, bits = residual_form(header, blocks, 0, exact_views=True), 0.0
    for block in blocks:
        coded, ones, _ = _native.code_residual(block, np.zeros_like(block), encode_header(header), form)
        bits -= float(np.log2(np.where(coded, ones, 65536 - ones) / 65536).sum())
    pixels: int = sum(block.shape[0] * block.shape[1] for block in blocks)
    return bits / pixels
