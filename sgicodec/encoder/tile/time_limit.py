"""A limit of time: what it leaves to the fit and the search of a tile."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

__all__ = ["TimeLimit"]

_CODING_SECONDS = 1.2
"""Of one stream of a megapixel, twice and generously."""
_SCOUTING_SECONDS, _SCOUTING_SHARE = 2.0, 8.0
"""Of a megapixel, generously; how many times that must be left."""
_SEARCHING_SHARE = 0.12
"""Of the time that is left for fit and search together."""


@dataclass(frozen=True)
class TimeLimit:
    """limit: seconds that the encode may take, None for any; started: a value of time.monotonic(); pixels: of the
    tile.
    """

    limit: float | None
    started: float
    pixels: int

    @property
    def end(self) -> float:
        """When the limit is over, a value of time.monotonic()."""
        return math.inf if self.limit is None else self.started + self.limit

    @property
    def search_end(self) -> float:
        """When the search after a fit must end, so that the stream is written in time."""
        return self.end - 0.5 * self._coding_seconds

    @property
    def can_scout(self) -> bool:
        """Whether there is room for a short fit that looks at what texture costs."""
        return self.end - time.monotonic() > _SCOUTING_SHARE * _SCOUTING_SECONDS * self.pixels / 1e6

    def of_fit(self, share: float, searches: bool) -> float | None:
        """Seconds that are left for the fit itself, None for any; `share` of what a search would take stays."""
        if self.limit is None:
            return None
        left = self.end - time.monotonic()
        searching = _SEARCHING_SHARE * share * left if searches else 0.0
        return max(0.5 * left, left - self._coding_seconds - searching, 1e-3)

    @property
    def _coding_seconds(self) -> float:
        """Of two streams, generously."""
        return _CODING_SECONDS * (0.2 + self.pixels / 1e6)
