"""Limits of memory, in made-up trees of files as Linux shows them."""

from __future__ import annotations

from pathlib import Path

import pytest

from sgicodec.executors.available import group_memory, machine_memory
from sgicodec.executors.executor import Memory
from sgicodec.executors.processes import ProcessExecutor

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


def test_the_machine(tmp_path: Path) -> None:
    assert machine_memory(tree(tmp_path, {"proc/meminfo": "MemFree: 5 kB\nMemTotal:  24105 kB"})) == 24105 << 10
    assert machine_memory(tmp_path / "none") is None


def test_only_as_many_workers_start_as_the_group_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nobody says how much memory they may take; a single one always starts."""
    memory = Memory(main=100, worker=200, shared=100)
    for limit, workers in ((None, 4), (10_000, 4), (800, 3), (600, 2), (100, 1)):
        monkeypatch.setattr("sgicodec.executors.available.group_memory", lambda limit=limit: limit)
        assert ProcessExecutor(4).within(memory, 9).workers == workers
    assert ProcessExecutor(4, max_memory=900).within(memory, 9).workers == 4
