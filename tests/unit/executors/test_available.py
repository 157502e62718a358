"""Limits of memory, in made-up trees of files as Linux shows them."""

from __future__ import annotations

from pathlib import Path

import pytest

from sgicodec.executors.available import group_memory

UNLIMITED = "9223372036854771712"


def tree(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n")
    return root


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({}, None),
        ({"proc/self/cgroup": "0::/"}, None),
        ({"proc/self/cgroup": "0::/", "sys/fs/cgroup/memory.max": "max"}, None),
        ({"proc/self/cgroup": "0::/", "sys/fs/cgroup/memory.max": "1000"}, 1000),
        (
            {
                "proc/self/cgroup": "0::/a/b",
                "sys/fs/cgroup/a/b/memory.max": "max",
                "sys/fs/cgroup/a/memory.max": "2000",
                "sys/fs/cgroup/memory.max": "3000",
                "sys/fs/memory.max": "1",
            },
            2000,
        ),
        ({"proc/self/cgroup": "0::/docker/of/the/host", "sys/fs/cgroup/memory.max": "4000"}, 4000),
        (
            {
                "proc/self/cgroup": "8:pids:/\n4:cpu,memory:/x\n0::/",
                "sys/fs/cgroup/memory/x/memory.limit_in_bytes": "5000",
                "sys/fs/cgroup/memory/memory.limit_in_bytes": UNLIMITED,
                "sys/fs/cgroup/pids/memory.limit_in_bytes": "1",
                "sys/fs/cgroup/unified/memory.max": "6000",
            },
            5000,
        ),
        (
            {
                "proc/self/cgroup": "4:memory:/\n",
                "sys/fs/cgroup/memory/memory.limit_in_bytes": UNLIMITED,
                "sys/fs/cgroup/unified/memory.max": "1",
            },
            None,
        ),
    ],
)
def test_control_groups(files: dict[str, str], expected: int | None, tmp_path: Path) -> None:
    assert group_memory(tree(tmp_path, files)) == expected
