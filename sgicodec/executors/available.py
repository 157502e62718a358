"""The memory that this process may take: of the machine, or less in a container or under a batch system."""

from __future__ import annotations

from pathlib import Path

_UNLIMITED = 1 << 60
"""What the first version of control groups states where there is no limit is some pages below 2⁶³."""


def machine_memory(root: Path = Path("/")) -> int | None:
    """Bytes that the machine has; None where the system does not tell."""
    for line in _lines(root / "proc/meminfo"):
        if line.startswith("MemTotal:"):
            return 1024 * int(line.split()[1])
    return None


def group_memory(root: Path = Path("/")) -> int | None:
    """Bytes that the control group of this process may take, and so the groups around it (Linux, both versions); None
    without a limit. Whoever takes more is ended without a word.
    """
    found = list[int]()
    for line in filter(None, _lines(root / "proc/self/cgroup")):
        _, controllers, path = line.split(":", 2)
        if not controllers:
            found += _limits(root / "sys/fs/cgroup", path, "memory.max")
            found += _limits(root / "sys/fs/cgroup/unified", path, "memory.max")
        elif "memory" in controllers.split(","):
            found += _limits(root / "sys/fs/cgroup/memory", path, "memory.limit_in_bytes")
    return min(found, default=None)


def _limits(top: Path, path: str, name: str) -> list[int]:
    """Those of a group and of all around it; in a container, some of them lie outside of what is mounted."""
    group = top / path.lstrip("/")
    folders = [group, *group.parents]
    stated = [_lines(folder / name) for folder in folders if folder == top or top in folder.parents]
    values = [int(lines[0]) for lines in stated if lines and lines[0].strip().isdecimal()]
    return [value for value in values if value < _UNLIMITED]


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text("utf-8", "replace").splitlines()
    except OSError:
        return []
