"""Measurements that take turns."""

from __future__ import annotations

from pathlib import Path

from benchmarks._turns import in_turn, median_seconds


def test_pythons_take_turns_and_change_who_comes_first() -> None:
    called: list[str] = []

    def run(python: Path) -> str:
        called.append(python.name)
        return f"{python.name}{len(called)}"

    found = in_turn([Path("a"), Path("b")], 2, run)
    assert called == ["b", "a", "a", "b"]
    assert found == [["a2", "a3"], ["b1", "b4"]]


def test_medians_leave_out_the_first_turn() -> None:
    moments = iter([0.0, 100.0, 101.0, 101.0, 103.0, 103.0, 112.0])
    called: list[int] = []
    assert median_seconds([lambda: called.append(1)], 3, lambda: next(moments)) == [2.0]
    assert len(called) == 4
