"""tests/unit mirrors the package: test_X.py lies where X.py lies, and what is tested elsewhere is listed here."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent

TESTED_ELSEWHERE = {
    "bench/launch": "unit/bench/test_peak.py",
    "bench/options": "unit/bench/test_command.py",
    "bench/optional_peers": "unit/bench/test_peers.py",
    "bench/peer": "unit/bench/test_peers.py",
    "bench/plots": "unit/bench/test_summary.py",
    "bench/tables": "unit/bench/test_summary.py",
    "benchmarks/_cuda_checks": "unit/benchmarks/test_cuda.py",
    "benchmarks/_cuda_reference": "unit/benchmarks/test_cuda.py",
    "benchmarks/_cuda_floors": "unit/benchmarks/test_cuda.py",
    "benchmarks/_decode_cases": "unit/benchmarks/test_decode.py",
    "benchmarks/_turns": "unit/benchmarks/test_turns.py",
    "benchmarks/figure": "unit/benchmarks/test_runner.py",
    "benchmarks/large/*": "unit/benchmarks/large/test_trips.py",
    "benchmarks/profile": "unit/benchmarks/test_speed.py",
    "bitstream/entropy/*": "unit/bitstream/entropy/test_symbol_writer.py",
    "bitstream/parts/predicted_tree": "unit/bitstream/parts/test_predicted_positions.py",
    "bitstream/parts/prior": "unit/bitstream/parts/test_attributes.py",
    "bitstream/parts/seed_tree": "unit/bitstream/parts/test_predicted_positions.py",
    "bitstream/parts/tile*": "conformance/test_determinism.py",
    "bitstream/printable": "system/cli/test_info.py",
    "bitstream/stream_*": "unit/bitstream/test_container.py",
    "cli/*": "system/cli",
    "cuda/tiles": "unit/raster/test_cuda.py",
    "decoder/*": "system/test_tiled_codec.py",
    "device": "conformance/test_instruction_sets.py",
    "encoder/*": "system",
    "errors": "system/cli/test_main.py",
    "executors/*": "system/large",
    "fit/*": "unit/fit/test_fused_step.py",
    "image/*": "unit/image/test_reader.py",
    "metadata/*": "unit/metadata/test_embedded.py",
    "metrics/*": "unit/metrics/test_distortion.py",
    "profiles/*": "unit/profiles/test_profiles.py",
    "rate_control/*": "system/test_targets.py",
    "raster/cuda_samples": "unit/raster/test_cuda.py",
    "raster/cuda_texture": "unit/raster/test_painter.py",
    "rdoq/settings": "unit/rdoq/test_rdoq.py",
    "server/*": "system/server",
    "tools/*": "unit/tools/test_programs.py",
    "version": "system/cli/test_main.py",
}
"""Modules without a file of their own in tests/unit, and what tests them. Where one pattern is the name of a room,
its modules are the parts of one thing, which is tested as a whole.
"""

OF_NO_MODULE = {
    "benchmarks/runner": "python -m benchmarks",
    "benchmarks/turns": "benchmarks/_turns.py, which is no program",
    "bitstream/entropy/range_decoder": "native code",
    "documentation": "all documents",
    "includes": "the folders of native/",
    "layers": "all modules",
    "mirror": "this file",
    "model/base_view": "native code",
    "native/header": "native code",
    "native/read_tile": "native code",
    "native/samples": "native code",
    "native/seed_gaussians": "native code",
    "native/shipped": "native code",
    "native/stream": "native code",
    "native/stream_reader": "native code",
    "native/stubs": "the types of native code",
    "native/thread_pool": "native code",
    "native/tile_grid": "native code",
    "native/vector": "native code",
    "profiles/profiles": "the package",
    "raster/bad_numbers": "raster/cpu with numbers of any kind",
    "raster/draw": "native code",
    "raster/rasterize": "the function of sgicodec.raster",
    "tools/programs": "all programs of tools/",
}
"""Test files that have no module of their name, and what they test."""


def modules() -> set[str]:
    """The package's modules from its folder on, those of benchmarks/ and tools/ from the root on; and packages."""
    found = set()
    for top, base in (("sgicodec", ROOT / "sgicodec"), ("benchmarks", ROOT), ("tools", ROOT)):
        for path in ROOT.glob(f"{top}/**/*.py"):
            if not path.name.startswith("__"):
                found.add(path.relative_to(base).with_suffix("").as_posix())
    return found


def unit_tests() -> set[str]:
    """Where the module of each unit test would lie."""
    folder = TESTS / "unit"
    paths = (path.relative_to(folder) for path in folder.glob("**/test_*.py"))
    return {(path.parent / path.stem.removeprefix("test_")).as_posix() for path in paths}


def is_package(name: str) -> bool:
    return any((base / name / "__init__.py").exists() for base in (ROOT, ROOT / "sgicodec"))


def test_every_module_is_tested() -> None:
    untested = modules() - unit_tests()
    assert [name for name in sorted(untested) if not any(fnmatch(name, pattern) for pattern in TESTED_ELSEWHERE)] == []


def test_every_unit_test_has_its_module() -> None:
    without = {name for name in unit_tests() - modules() if not is_package(name)}
    assert without == set(OF_NO_MODULE)


@pytest.mark.parametrize("pattern", TESTED_ELSEWHERE)
def test_the_list_holds_nothing_but_exceptions(pattern: str) -> None:
    assert any(fnmatch(name, pattern) for name in modules() - unit_tests())
    assert (TESTS / TESTED_ELSEWHERE[pattern]).exists()
