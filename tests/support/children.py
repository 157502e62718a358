"""The processes that this one has started and that still run."""

from __future__ import annotations

import os
import signal
from contextlib import suppress
from pathlib import Path

HANGS = 600
"""Seconds after which a process counts as one that hangs: far more than any takes on the busiest machine."""

HELPERS = ("multiprocessing.resource_tracker", "multiprocessing.forkserver", "loky.backend.resource_tracker")
"""What multiprocessing starts once and ends with this process."""


def children() -> dict[int, str]:
    """Command lines by process id, empty where a process is about to start; nothing on systems without /proc."""
    found = {}
    for path in Path("/proc/self/task").glob("*/children"):
        with suppress(OSError):
            for pid in path.read_text().split():
                if not ended(pid):
                    command = Path(f"/proc/{pid}/cmdline").read_bytes()
                    found[int(pid)] = command.replace(b"\0", b" ").decode(errors="replace")
    return found


def ended(pid: str) -> bool:
    """Whether a process has ended and its status was not read yet."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"


def end_children() -> dict[int, str]:
    """Kills all children but multiprocessing's helpers, waits for their end and returns those that still ran."""
    found = {pid: command for pid, command in children().items() if not any(helper in command for helper in HELPERS)}
    for pid in found:
        with suppress(OSError):
            os.kill(pid, signal.SIGKILL)
        with suppress(OSError):
            os.waitpid(pid, 0)
    return found
