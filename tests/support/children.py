"""The processes that this one has started and that still run."""

from __future__ import annotations

import os
import signal
from contextlib import suppress
from pathlib import Path

HELPERS = (b"multiprocessing.resource_tracker", b"multiprocessing.forkserver", b"loky.backend.resource_tracker")
"""What multiprocessing starts once and ends with this process."""


def children() -> dict[int, bytes]:
    """Command lines by process id; nothing on systems without /proc."""
    found = {}
    for path in Path("/proc/self/task").glob("*/children"):
        with suppress(OSError):
            for pid in path.read_text().split():
                found[int(pid)] = Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ")
    return found


def end_children() -> list[bytes]:
    """Kills all children but multiprocessing's helpers, waits for their end and names those that still ran."""
    ended = []
    for pid, command in children().items():
        if any(helper in command for helper in HELPERS):
            continue
        with suppress(OSError):
            os.kill(pid, signal.SIGKILL)
        with suppress(OSError):
            os.waitpid(pid, 0)
        if command:  # none: a child that had ended, and that nobody had waited for
            ended.append(command)
    return ended
