"""Layouts: what the channels of a picture mean."""

from __future__ import annotations

__all__ = ["LAYOUTS", "WITHOUT_ALPHA", "alpha_index"]

LAYOUTS = {"gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}
"""Channel count of each layout with a meaning; any other stack of bands is "multi"."""

WITHOUT_ALPHA = {"gray+alpha": "gray", "rgba": "rgb"}
"""What layouts with alpha are without it."""


def alpha_index(channels: str) -> int | None:
    """Index of the alpha channel in a layout, or None."""
    return LAYOUTS[channels] - 1 if channels in WITHOUT_ALPHA else None
