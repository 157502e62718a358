"""Ctrl-C during a fit: once to end it early, twice to give up."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType

__all__ = ["EarlyEnd"]


class EarlyEnd:
    """A context in which, once `arm` was called, the first SIGINT only sets `asked`; the next one interrupts as ever.

    A process that ignores SIGINT goes on ignoring it.
    """

    def __init__(self) -> None:
        self.asked = False
        self._armed = False

    def __enter__(self) -> EarlyEnd:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._armed:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def arm(self) -> None:
        """Takes over SIGINT; from the second call on does nothing."""
        mine = threading.current_thread() is threading.main_thread()
        if not self._armed and mine and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self._armed = True
            signal.signal(signal.SIGINT, self._note)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        signal.signal(signal.SIGINT, signal.default_int_handler)
