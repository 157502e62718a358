"""Every kernel compiles for every architecture, within bounds, without a GPU or a driver."""

from __future__ import annotations

import ctypes
import os
import re
from pathlib import Path
from typing import Any

import pytest

from sgicodec.cuda import compiler, sources
from sgicodec.cuda.compiler import ARCHITECTURES, Compiler, Resources, compiled
from sgicodec.errors import MissingExtraError, NoDeviceError, SgiError

REGISTERS, TILE_REGISTERS, SHARED, SPILLED = 168, 96, 24 << 10, {"absolute_error_4": 24}
"""Bounds. A multiprocessor of sm_75, the least, has 65,536 registers and 64 kB of shared memory. Registers are enough
for five blocks of the tile kernels (128 threads) and for six of the others that take most (64 threads); memory for two
blocks of the kernel that takes most of it, and, at 15 kB, for four of the tile kernels of three channels. All but one
spill 16 bytes at most.
"""
TILES = re.compile(r"(forward|error|absolute_error|backward)_\d")


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
    many = {"forward", "error", "absolute_error", "backward", "reduce"}
    assert many <= found
    return found - many | {f"{name}_{channels}" for name in many for channels in range(1, 5)}


def check(resources: dict[str, Resources]) -> None:
    assert resources.keys() == names_in_sources()
    for name, needs in resources.items():
        assert 0 < needs.registers <= (TILE_REGISTERS if TILES.fullmatch(name) else REGISTERS), (name, needs)
        assert needs.shared <= SHARED, (name, needs)
        assert needs.spilled <= SPILLED.get(name, 16), (name, needs)


@pytest.mark.slow
@pytest.mark.parametrize("architecture", ARCHITECTURES)
def test_every_kernel_compiles_within_bounds(nvrtc: Compiler, architecture: int) -> None:
    check(nvrtc.resources(architecture))


@pytest.mark.slow
def test_machine_code_and_ptx(nvrtc: Compiler) -> None:
    assert nvrtc.cubin(75)[:4] == b"\x7fELF"
    assert b".target sm_120" in nvrtc.ptx(120)


@pytest.mark.slow
def test_an_architecture_that_came_later_gets_ptx(nvrtc: Compiler) -> None:
    """Of the latest before it, which drivers compile further."""
    assert set(ARCHITECTURES) <= set(nvrtc.architectures)
    latest = nvrtc.architectures[-1]
    code = nvrtc.code(latest + 10)
    assert f".target sm_{latest}".encode() in code
    assert code.endswith(b"\0")
    assert nvrtc.code(75)[:4] == b"\x7fELF"


def test_which_code_an_architecture_gets(nvrtc: Compiler, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Compiler, "architectures", [75, 90, 120])
    monkeypatch.setattr(Compiler, "_compile", lambda self, target, kind, *more: f"{target} {kind}".encode())
    found = [nvrtc.code(architecture) for architecture in (75, 120, 89, 130)]
    assert found == [b"sm_75 CUBIN", b"sm_120 CUBIN", b"compute_75 PTX", b"compute_120 PTX"]
    with pytest.raises(NoDeviceError, match=r"compute capability 7\.0; NVRTC .* needs 7\.5 or more"):
        nvrtc.code(70)


class Pretended:
    """A compiler that is asked only once for each architecture."""

    def __init__(self, version: str = "13.0") -> None:
        self.version, self.asked = version, list[int]()

    def code(self, architecture: int) -> bytes:
        self.asked.append(architecture)
        return b"code %d" % architecture


def test_the_cache_holds_what_was_compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pretended = Pretended()
    monkeypatch.setattr(compiler, "the_compiler", lambda most: pretended)
    for architecture in (80, 90, 80, 90):
        assert compiled(architecture, 13, tmp_path / "new") == b"code %d" % architecture
    assert pretended.asked == [80, 90]
    pretended.version = "13.1"
    compiled(80, 13, tmp_path / "new")
    assert pretended.asked == [80, 90, 80]


def test_a_folder_that_cannot_be_written_costs_time_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("in the way")
    pretended = Pretended()
    monkeypatch.setattr(compiler, "the_compiler", lambda most: pretended)
    for _ in range(2):
        assert compiled(75, 13, tmp_path / "file" / "cache") == b"code 75"
    assert pretended.asked == [75, 75]


def test_the_cache_is_where_caches_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler, "the_compiler", lambda most: Pretended())
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    compiled(75, 13)
    assert [path.suffix for path in (tmp_path / "sgicodec" / "cuda").iterdir()] == [".cubin"]


def test_what_does_not_compile_says_where(nvrtc: Compiler, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cuda").mkdir()
    (tmp_path / "cuda" / "kernels.cu").write_text("int f() { return nothing; }")
    monkeypatch.setattr(sources, "root", lambda: tmp_path)
    with pytest.raises(SgiError, match=r"nothing.*undefined"):
        nvrtc.cubin(90)


def test_without_nvrtc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler, "_packaged", list)
    monkeypatch.setattr(compiler, "_NAMES", ("libno-such-library.so.1",))
    with pytest.raises(MissingExtraError, match=r"pip install 'sgicodec\[cuda\]'"):
        Compiler()


class Library:
    """NVRTC of a version."""

    def __init__(self, name: str) -> None:
        self.major = int(name.rpartition(".")[2])
        self.nvrtcGetErrorString = ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_int)(lambda status: b"")

    def nvrtcVersion(self, major: Any, minor: Any) -> int:
        major._obj.value, minor._obj.value = self.major, 4
        return 0


def test_the_driver_must_know_what_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """The latest that it knows; a message where all are later."""
    monkeypatch.setattr(compiler, "_packaged", list)
    monkeypatch.setattr(compiler, "_NAMES", ("libnvrtc.so.13", "libnvrtc.so.12"))
    monkeypatch.setattr(ctypes, "CDLL", Library)
    assert [Compiler(most).version for most in (14, 13, 12)] == ["13.4", "13.4", "12.4"]
    with pytest.raises(MissingExtraError, match=r"NVRTC 12.4 is later than the driver's CUDA 11: .*nvrtc-cu11$"):
        Compiler(11)
