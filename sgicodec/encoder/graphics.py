"""Pictures of text, line art and screens: pixels repeat each other, and exact ones show the picture at every scale."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.metadata.layouts import alpha_index

__all__ = ["Repeats", "may_have_views"]


class Repeats:
    """How many pixels are as the one to their left."""

    def __init__(self) -> None:
        self._alike = self._count = 0

    def see(self, pixels: NDArray[Any]) -> None:
        """More pixels [h, w, C]."""
        self._alike += int(np.count_nonzero((pixels[:, 1:] == pixels[:, :-1]).all(axis=2)))
        self._count += pixels.shape[0] * pixels.shape[1]

    @property
    def are_usual(self) -> bool:
        """Whether more than half are, as in text, line art and screens."""
        return 2 * self._alike > self._count


def may_have_views(header: Header) -> bool:
    """Whether a residual layer may show this picture at other scales: one of which every sample counts alike."""
    return header.masked is None and not header.has_exact and alpha_index(header.channels) is None
