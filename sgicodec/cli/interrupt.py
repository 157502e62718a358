"""Ctrl-C during a fit: once to end it early, twice to give up."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from types import FrameType, TracebackType

_GRACE_SECONDS = 1.0
"""What the second SIGINT leaves to Python, which hears of it only between calls of native code."""

_INTERRUPTED = 130


class EarlyEnd:
    """A context in which, once `arm` was called, the first SIGINT only sets `asked`; the next one interrupts as ever,
    and ends the process where the context is not left within a second.

    A process that ignores SIGINT goes on ignoring it.
    """

    def __init__(self) -> None:
        self.asked = False
        self._armed = False
        self._left = threading.Event()
        self._sink, self._others = -1, -1

    def __enter__(self) -> EarlyEnd:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._left.set()
        if self._armed:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            signal.set_wakeup_fd(self._others)
            os.close(self._sink)

    def arm(self) -> None:
        """Takes over SIGINT; from the second call on does nothing."""
        mine = threading.current_thread() is threading.main_thread()
        if not self._armed and mine and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self._armed = True
            source, self._sink = os.pipe()
            os.set_blocking(self._sink, False)
            self._others = signal.set_wakeup_fd(self._sink, warn_on_full_buffer=False)
            threading.Thread(target=self._watch, args=(source,), daemon=True).start()
            signal.signal(signal.SIGINT, self._note)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def _watch(self, source: int) -> None:
        """Reads the number of each signal as it comes, until the context is left."""
        interrupts = 0
        with open(source, "rb", buffering=0) as pipe:
            while numbers := pipe.read(64):
                interrupts += numbers.count(signal.SIGINT)
                if interrupts > 1 and not self._left.wait(_GRACE_SECONDS):
                    _end()


def _end() -> None:
    with contextlib.suppress(OSError):
        shown = b"\x1b[?25h\r" if sys.stderr is not None and sys.stderr.isatty() else b""  # the cursor, hidden by a bar
        os.write(2, shown + b"sgi: interrupted\n")
    os._exit(_INTERRUPTED)
