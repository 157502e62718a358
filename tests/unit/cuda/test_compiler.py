"""Every kernel compiles for every architecture, within bounds, without a GPU or a driver."""

from __future__ import annotations

import os
import re
from pathlib import Path
from unittest.mock import Mock, call

import pytest

from benchmarks._cuda_resources import ARCHITECTURES, resources
from sgicodec.cuda import compiler, sources
from sgicodec.cuda.compiler import Compiler, compiled
from sgicodec.errors import MissingExtraError, SgiError

REGISTERS, TILE_REGISTERS, SHARED, SPILLED = 168, 96, 24 << 10, {"absolute_error_4": 24}
"""Bounds. A multiprocessor of sm_75, the least, has 65,536 registers and 64 kB of shared memory. Registers are enough
for five blocks of the tile kernels (128 threads) and for six of the others that take most (64 threads); memory for two
blocks of the kernel that takes most of it, and, at 15 kB, for four of the tile kernels of three channels. All but one
spill 16 bytes at most.
"""
TILES = re.compile(r"(forward|error|absolute_error)_\d")


@pytest.fixture(scope="module")
def nvrtc() -> Compiler:
    if "libasan" in os.environ.get("LD_PRELOAD", ""):
        pytest.skip("AddressSanitizer's dlopen does not find what lies beside NVRTC")
    try:
        return Compiler()
    except MissingExtraError:
        pytest.skip("no NVRTC: pip install nvidia-cuda-nvrtc")


def names_in_sources() -> set[str]:
    """All kernels, with those that a macro makes for 1 to 4 channels."""
    text = "".join(path.read_text("utf-8") for path in (sources.root() / "cuda").rglob("*.hpp"))
    found = set(re.findall(r"^ *SGI_KERNEL\((\w+?)(?:_##C)?,", text, re.MULTILINE))
    many = {"forward", "error", "absolute_error", "reduce"}
    assert many <= found
    return found - many | {f"{name}_{channels}" for name in many for channels in range(1, 5)}


@pytest.mark.slow
@pytest.mark.parametrize("architecture", ARCHITECTURES)
def test_every_kernel_compiles_within_bounds(nvrtc: Compiler, architecture: int) -> None:
    found = resources(nvrtc, architecture)
    assert found.keys() == names_in_sources()
    for name, needs in found.items():
        assert 0 < needs.registers <= (TILE_REGISTERS if TILES.fullmatch(name) else REGISTERS), (name, needs)
        assert needs.shared <= SHARED, (name, needs)
        assert needs.spilled <= SPILLED.get(name, 16), (name, needs)


@pytest.mark.slow
def test_machine_code_and_ptx(nvrtc: Compiler) -> None:
    assert nvrtc.compile("sm_75", "CUBIN")[:4] == b"\x7fELF"
    assert b".target sm_120" in nvrtc.compile("compute_120", "PTX")


def test_the_cache_holds_what_was_compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And a compiler is asked once for each architecture."""
    pretended = Mock(version="13.0", code=Mock(side_effect=lambda architecture: b"code %d" % architecture))
    monkeypatch.setattr(compiler, "the_compiler", lambda most: pretended)
    for architecture in (80, 90, 80, 90):
        assert compiled(architecture, 13, tmp_path / "new") == b"code %d" % architecture
    assert pretended.code.mock_calls == [call(80), call(90)]
    pretended.version = "13.1"
    compiled(80, 13, tmp_path / "new")
    assert pretended.code.mock_calls == [call(80), call(90), call(80)]


def test_what_does_not_compile_says_where(nvrtc: Compiler, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cuda").mkdir()
    (tmp_path / "cuda" / "kernels.cu").write_text("int f() { return nothing; }")
    monkeypatch.setattr(sources, "root", lambda: tmp_path)
    with pytest.raises(SgiError, match=r"nothing.*undefined"):
        nvrtc.compile("sm_90", "CUBIN")
