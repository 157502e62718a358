"""Imports run downward (docs/architecture.md), no two files or rooms import each other, each library has one home."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter

import pytest
from data_files import ROOT

_STATED = (ROOT / "docs" / "architecture.md").read_text("utf-8").split("## What imports what")[1].split("\n- ")[0]
FLOORS = [set(line.strip().split(", ")) for line in reversed(re.findall(r"^    ([\w, ]+)$", _STATED, re.MULTILINE))]
"""Rooms from the ground up, as the page has them: each may import what lies below its floor, not beside it."""

HOMES = {
    "OpenImageIO": ("sgicodec/image/",),
    "torch": ("tools/", "sgicodec/metrics/learned.py"),
    "tests": (
        "tools/train_prior.py",
        "benchmarks/_cuda_checks.py",
    ),  # the fit's step in torch, the rasteriser's in numpy
    "torchmetrics": ("sgicodec/metrics/learned.py",),
    "torchvision": ("sgicodec/metrics/learned.py",),
    "rich": ("sgicodec/cli/", "sgicodec/bench/"),
    "isal": ("sgicodec/image/png_output.py",),
    "threadpoolctl": ("sgicodec/encoder/tiles/runner.py", "benchmarks/raster.py"),
    "click": ("sgicodec/cli/", "sgicodec/bench/", "benchmarks/", "tools/"),
    "scipy": ("sgicodec/metrics/similarity.py", "sgicodec/bench/bdrate.py", "sgicodec/bench/confidence.py"),
    "ssimulacra2": ("sgicodec/metrics/perceptual.py",),
    "flip_evaluator": ("sgicodec/metrics/perceptual.py",),
    "pycvvdp": ("sgicodec/metrics/perceptual.py",),
    "PIL": (
        "sgicodec/image/avif_reader.py",
        "sgicodec/image/pillow_reader.py",
        "sgicodec/image/conversion.py",
        "sgicodec/image/slide_reader.py",
        "sgicodec/bench/",
        "sgicodec/plugins/",
        "sgicodec/server/",
        "benchmarks/",
    ),
    "pillow_heif": ("sgicodec/image/heif_reader.py",),
    "rawpy": ("sgicodec/image/raw_reader.py",),
    "openslide": ("sgicodec/image/slide_reader.py",),
    "imagecodecs": (
        "sgicodec/image/jpegxl_reader.py",
        "sgicodec/image/avif_reader.py",
        "sgicodec/image/jpeg2000_reader.py",
        "sgicodec/metadata/jxl.py",
        "sgicodec/bench/",
        "benchmarks/",
    ),
    "matplotlib": ("sgicodec/bench/",),
    "distributed": ("sgicodec/executors/dask.py",),
    "starlette": ("sgicodec/server/",),
    "uvicorn": ("sgicodec/server/",),
    "fsspec": ("sgicodec/remote/",),
    "tifffile": ("sgicodec/plugins/pyramid.py", "sgicodec/plugins/ome_xml.py"),
    "dask": ("sgicodec/plugins/dask.py",),
    "imageio": ("sgicodec/plugins/imageio.py",),
    "xarray": ("sgicodec/plugins/xarray.py",),
    "zarr": ("sgicodec/plugins/zarr.py", "sgicodec/plugins/ome_zarr.py", "sgicodec/image/zarr_reader.py"),
    "numcodecs": ("sgicodec/plugins/numcodecs.py",),
    "rasterio": ("sgicodec/image/gdal_place.py", "sgicodec/image/tiff_reader.py", "sgicodec/plugins/cog.py"),
    "mpmath": ("tools/make_tables.py",),
}

SOURCES = sorted(
    path.relative_to(ROOT).as_posix()
    for folder in ("sgicodec", "benchmarks", "tools")
    for path in ROOT.glob(f"{folder}/**/*.py")
)


def module_of(source: str) -> str:
    return source.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


MODULES = {module_of(source): source for source in SOURCES}


def room_of(module: str) -> str:
    """The second part of a name in the package, the first of one outside."""
    first, _, rest = module.partition(".")
    return rest.split(".")[0] if first == "sgicodec" else first


@cache
def imported(source: str) -> frozenset[str]:
    """Full names of all modules that a file imports, at its top or later, for types or in earnest."""
    return frozenset(_imported(source))


def _imported(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse((ROOT / source).read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.module is not None
            assert node.level == 0, "names are written in full"
            for alias in node.names:
                name = f"{node.module}.{alias.name}"
                yield name if name in MODULES or name == "sgicodec._native" else node.module


@pytest.mark.parametrize("source", [source for source in SOURCES if source.count("/") > 1 or "sgicodec/" not in source])
def test_imports_run_downward(source: str) -> None:
    room = room_of(module_of(source))
    floor = next(number for number, rooms in enumerate(FLOORS) if room in rooms)
    below = set().union(*FLOORS[:floor]) | {room, ""}
    used = {room_of(name) for name in imported(source) if name.split(".")[0] in ("sgicodec", "benchmarks", "tools")}
    assert used <= below


def test_no_file_imports_itself_in_a_circle() -> None:
    facade = "sgicodec"  # its names load on first use
    graph = {m: imported(s) & MODULES.keys() - {facade, m} for m, s in MODULES.items() if m != facade}
    TopologicalSorter(graph).prepare()


def test_nothing_lies_loose_in_the_package() -> None:
    loose = {source.removeprefix("sgicodec/") for source in SOURCES if source.count("/") == 1 and "sgicodec/" in source}
    assert loose == {"__init__.py", "__main__.py", "arrays.py", "device.py", "errors.py", "picture.py", "version.py"}


@pytest.mark.parametrize("library", HOMES)
def test_every_library_has_its_home(library: str) -> None:
    users = [source for source in SOURCES if library in {name.split(".")[0] for name in imported(source)}]
    assert [source for source in users if not source.startswith(HOMES[library])] == []
    assert [home for home in HOMES[library] if not any(source.startswith(home) for source in users)] == []


def test_nothing_else_is_imported() -> None:
    names = {name.split(".")[0] for source in SOURCES for name in imported(source)}
    assert names - set(sys.stdlib_module_names) == {"sgicodec", "benchmarks", "tools", "numpy", *HOMES}
