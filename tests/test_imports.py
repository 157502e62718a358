"""Imports run downward (docs/architecture.md), and each foreign library has one home."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import sgicodec

ROOT = Path(sgicodec.__file__).parent

LAYERS = {
    "model": {"errors", "_native"},
    "raster": {"errors", "_native"},
    "image": {"errors", "_native"},
    "metrics": {"errors"},
    "files": {"errors"},
    "tiles": {"errors"},
    "fill": set(),
    "bitstream": {"errors", "model", "tiles", "_native"},
    "fit": {"errors", "_native", "model", "raster"},
    "opened": {"errors", "bitstream"},
    "view": {"errors", "bitstream"},
    "drawn_tile": {"errors", "bitstream", "model", "raster", "view"},
    "masking": {"bitstream", "drawn_tile", "image", "view"},
    "kept_tiles": {"_native", "drawn_tile", "errors", "opened", "view"},
    "drawing": {"bitstream", "drawn_tile", "image", "kept_tiles", "masking", "raster", "tiles", "view"},
    "bands": {"bitstream", "image", "view"},
    "decoder": {
        *("bands", "bitstream", "drawing", "drawn_tile", "errors", "image", "kept_tiles", "opened", "raster", "view"),
    },
    "trim": {"fit", "model"},
    "refine": {"_native", "bitstream", "model", "raster"},
    "assembly": {"bitstream", "image"},
    "choice": set(),
    "distortion": {"image"},
    "tile_work": {
        *("bitstream", "decoder", "distortion", "encoding", "fit", "image", "model", "plan", "refine", "trim"),
    },
    "tile_weight": {"encoding", "image", "model", "plan"},
    "time_shares": {"tile_work", "tiles"},
    "outlook": {"fit", "tile_work"},
    "correction": {"outlook"},
    "overview": {"encode_settings", "image", "masking", "plan", "tiles", "view"},
    "round_roles": {"image", "plan", "tile_work"},
    "rounds": {
        *("assembly", "choice", "correction", "distortion", "fit", "outlook", "plan", "round_roles", "tile_work"),
        "time_shares",
    },
    "large": {
        *(
            "assembly",
            "bitstream",
            "decoder",
            "distortion",
            "encode_settings",
            "encoder",
            "encoding",
            "errors",
            "files",
            "image",
            "plan",
            "round_roles",
            "rounds",
            "tile_weight",
            "tile_work",
            "time_shares",
        ),
    },
    "encode_settings": {"errors", "bitstream", "fit", "tiles"},
    "plan": {"bitstream", "encode_settings", "errors", "fit", "image", "model", "tiles", "version"},
    "encoding": {
        *("assembly", "bitstream", "decoder", "fill", "fit", "image", "metrics", "model", "plan", "refine", "trim"),
    },
    "aim": {"distortion", "encoding", "errors", "fit", "model", "refine", "trim"},
    "encoder": {
        *("aim", "assembly", "decoder", "distortion", "encode_settings", "encoding", "errors", "fit", "image", "plan"),
        *("overview", "round_roles", "rounds", "tile_weight", "tile_work", "tiles", "time_shares"),
    },
}
"""What each part may import besides itself; `bench` and `cli` may import everything."""

HOMES = {
    "constriction": ("bitstream/entropy.py", "bitstream/symbol_models.py"),
    "OpenImageIO": ("image/",),
    "torch": ("fit/", "encoding.py", "bench/research.py"),
    "rich": ("cli/", "bench/"),
    "click": ("cli/", "bench/"),
    "PIL": ("bench/",),
    "imagecodecs": ("bench/",),
    "matplotlib": ("bench/",),
    "distributed": ("large/cluster.py",),
    "fsspec": ("large/task.py",),
    "mpmath": ("bitstream/make_tables.py",),
}

PROGRAMS = ("fit/train_prior.py", "fit/tune_prior.py", "fit/train_positions.py", "bitstream/make_tables.py")
"""Run by the package's makers with `python -m`; nothing imports them."""

SOURCES = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py"))


def imported(source: str) -> Iterator[str]:
    """Full names of all modules that a file imports, at its top or later, for types or in earnest."""
    folder = ["sgicodec", *source.split("/")[:-1]]
    for node in ast.walk(ast.parse((ROOT / source).read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = folder[: len(folder) + 1 - node.level] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"sgicodec.{alias.name}" for alias in node.names) if module == "sgicodec" else [module]


@pytest.mark.parametrize("source", SOURCES)
def test_imports_run_downward(source: str) -> None:
    part = source.split("/")[0].removesuffix(".py")
    used = {name.split(".")[1] for name in imported(source) if name.startswith("sgicodec.")} - {part}
    if source not in PROGRAMS and part in LAYERS:
        assert used <= LAYERS[part]
    if part not in ("cli", "bench", "__main__"):
        assert "cli" not in used


@pytest.mark.parametrize("library", HOMES)
def test_every_library_has_its_home(library: str) -> None:
    users = [source for source in SOURCES if library in {name.split(".")[0] for name in imported(source)}]
    assert users
    assert [source for source in users if not source.startswith(HOMES[library])] == []


def test_nothing_else_is_imported() -> None:
    names = {name.split(".")[0] for source in SOURCES for name in imported(source)}
    assert names - set(sys.stdlib_module_names) == {"sgicodec", "numpy", *HOMES}


def test_nothing_imports_programs() -> None:
    programs = {"sgicodec." + program.removesuffix(".py").replace("/", ".") for program in PROGRAMS}
    assert all(programs.isdisjoint(imported(source)) for source in SOURCES)


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import sgicodec", {"numpy", "torch", "OpenImageIO", "constriction", "click", "rich"}),
        ("import sgicodec; sgicodec.open_stream", {"torch", "OpenImageIO", "click", "rich"}),
        ("import sgicodec; sgicodec.read", {"torch", "constriction", "click", "rich"}),
        ("import sgicodec.encoder", {"torch", "OpenImageIO", "click", "rich"}),
    ],
)
def test_names_load_on_first_use(code: str, absent: set[str]) -> None:
    command = [sys.executable, "-c", f"{code}; import sys; print(*sys.modules)"]
    loaded = set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())
    assert not loaded & absent
