"""C++ includes run downward, as imports do, and never in a circle."""

from __future__ import annotations

import re
from collections import Counter
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

NATIVE = Path(__file__).resolve().parents[2] / "native"

LAYERS = {
    "base": set(),
    "image": {"base"},
    "metrics": {"base"},
    "model": {"base"},
    "raster": {"base"},
    "bitstream": {"base", "model"},
    "fit": {"base", "model", "raster"},
    "rdoq": {"base", "model", "raster", "bitstream"},
    "decoder": {"base", "model", "raster", "bitstream"},
    "capi": {"base", "model", "raster", "bitstream", "decoder"},
    "bindings": {"base", "image", "metrics", "model", "raster", "bitstream", "fit", "rdoq", "decoder"},
}
"""What each folder may include besides itself."""

SOURCES = sorted(path.relative_to(NATIVE).as_posix() for path in NATIVE.rglob("*.?pp"))


def included(source: str) -> set[str]:
    return set(re.findall(r'^\s*#\s*include "([^"]+)"', (NATIVE / source).read_text("utf-8"), re.MULTILINE))


@pytest.mark.parametrize("source", SOURCES)
def test_includes_run_downward(source: str) -> None:
    """Every file is named by its path from native/, lies there, and is in this folder or a lower one."""
    assert included(source) <= set(SOURCES)
    folder = source.split("/")[0]
    assert {name.split("/")[0] for name in included(source)} - {folder} <= LAYERS[folder]


def test_no_includes_are_circular() -> None:
    """Neither of files nor of folders: both orders exist."""
    assert len(list(TopologicalSorter({source: included(source) for source in SOURCES}).static_order())) == len(SOURCES)
    assert len(list(TopologicalSorter(LAYERS).static_order())) == len(LAYERS)


KERNELS = {"base": set(), "raster": {"base"}, "fit": {"base"}}
"""Folders of cuda/ that each of them may include."""
USED = {"base", "model", "raster", "fit"}
"""Folders of native/ that run on a GPU."""
CUDA = sorted(path.relative_to(NATIVE.parent).as_posix() for path in NATIVE.parent.glob("cuda/*/*.hpp"))


@pytest.mark.parametrize("source", CUDA)
def test_kernels_include_what_lies_below(source: str) -> None:
    """Their own folders, the arguments, and the headers of native/ that a GPU runs."""
    folder = source.split("/")[1]
    names = set(re.findall(r'^#include "([^"]+)"', (NATIVE.parent / source).read_text("utf-8"), re.MULTILINE))
    ours = {name for name in names if name.startswith("cuda/")} - {"cuda/arguments.hpp"}
    assert ours <= set(CUDA)
    assert {name.split("/")[1] for name in ours} - {folder} <= KERNELS[folder]
    assert {name.split("/")[0] for name in names if not name.startswith("cuda/")} <= USED
    assert {name for name in names if not name.startswith("cuda/")} <= set(SOURCES)


def test_only_bindings_know_python() -> None:
    users = [source for source in SOURCES if "nanobind" in (NATIVE / source).read_text("utf-8")]
    assert users
    assert [source for source in users if not source.startswith("bindings/")] == []


def test_types_have_names_of_their_own() -> None:
    """Two types of one name in headers would take each other's functions, and no compiler would say so."""
    named = Counter[str]()
    for source in SOURCES:
        if source.endswith(".hpp"):
            text = (NATIVE / source).read_text("utf-8")
            named.update(re.findall(r"^(?:struct|class|enum class) (\w+)\b[^;]*?\{", text, re.MULTILINE))
    assert named
    assert [name for name, times in named.items() if times > 1] == []
