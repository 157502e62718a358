"""Listeners for tests that watch an encode."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from sgicodec.encoder.progress import NullListener

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress


class Steps(NullListener):
    """Hands each step of a fit to a function, which says whether to go on."""

    def __init__(self, step: Callable[[Progress], bool]) -> None:
        self._step = step

    def step(self, progress: Progress) -> bool:
        """Called by the pipeline."""
        return self._step(progress)
