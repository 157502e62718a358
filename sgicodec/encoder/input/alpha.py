"""Alpha that says nothing: 0 or opaque everywhere. An encode leaves it out."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan, stream_plan
from sgicodec.metadata import geo
from sgicodec.metadata.layouts import WITHOUT_ALPHA, alpha_index
from sgicodec.model.tile_grid import TileGrid
from sgicodec.picture import Picture, opaque_mask

if TYPE_CHECKING:
    from sgicodec.encoder.listener import NullListener

__all__ = ["without_needless_alpha"]


def without_needless_alpha(windows: Windows, plan: Plan, listener: NullListener) -> tuple[Windows, Plan]:
    """A picture and its plan without an alpha that says nothing. The listener gets to know."""
    found = None if alpha_index(plan.header.channels) is None else _everywhere(windows, plan.header.grid)
    if found == "opaque":
        listener.remark("alpha is opaque everywhere; it is left out")
    elif found == "hiding" and plan.header.masked == "transparent":
        listener.note("alpha is 0 everywhere; it is left out, and the colours are kept")
    else:
        if alpha_index(plan.header.channels) is not None and geo.has_place(windows.shape.metadata.geo):
            listener.note(_BAND_AS_ALPHA + (_NOT_KEPT if plan.header.masked == "transparent" else ""))
        return windows, plan
    windows = _Colours(windows)
    return windows, stream_plan(windows.shape, plan.settings)


_BAND_AS_ALPHA = (
    "the last band is declared as alpha; if it is a band like the others, such as near infrared, read it with alpha as "
    "a band (--alpha band)"
)
_NOT_KEPT = ": where it is 0, the others are not kept"


def _everywhere(windows: Windows, grid: TileGrid) -> Literal["opaque", "hiding"] | None:
    """What alpha is in every pixel of a picture that has alpha: "opaque", or "hiding" colours that are there; None
    where it differs. No more is read than it takes to tell.
    """
    opaque = hiding = True
    colours = False
    for number in range(grid.count):
        picture = windows.read(*grid.core(number))
        pixels = picture.pixels
        opaque, hiding = opaque and bool(opaque_mask(picture).all()), hiding and not pixels[..., -1].any()
        if not (opaque or hiding):
            return None
        colours = colours or bool(pixels[..., :-1].any())
    if opaque:
        return "opaque"
    return "hiding" if colours else None


class _Colours:
    """The colours alone of a picture that has alpha."""

    def __init__(self, windows: Windows) -> None:
        self._windows, shape = windows, windows.shape
        self.shape = replace(shape, channels=WITHOUT_ALPHA[shape.channels], bands=shape.bands - 1)
        self.memory, self.digest, self.page = windows.memory, windows.digest, windows.page

    def read(self, x: int, y: int, width: int, height: int) -> Picture:
        picture = self._windows.read(x, y, width, height)
        return replace(picture, pixels=picture.pixels[..., :-1], channels=self.shape.channels)
