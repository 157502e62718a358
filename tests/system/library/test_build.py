"""libsgi as other programs find it: built, installed, linked to; the example in C."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN_STREAMS
from library import NEEDS_COMPILER, ROOT, Info, Library, Options, View
from PIL import Image

import sgicodec

pytestmark = NEEDS_COMPILER


HEADER = ROOT / "include" / "sgi.h"


@pytest.mark.skipif(not shutil.which("pkg-config"), reason="needs pkg-config")
@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_the_example_draws_golden_streams(path: Path, decoder: Path, tmp_path: Path) -> None:
    """What it writes is what `sgi decode` does."""
    out = tmp_path / "out.ppm"
    for options in [], ["0.6"]:
        subprocess.run([decoder, path, out, *options], check=True)
        shown = np.atleast_3d(np.asarray(Image.open(out)))
        with sgicodec.open(path) as stream:
            expected = stream.picture(size=(shown.shape[1], shown.shape[0]), dtype="uint8").pixels
        np.testing.assert_array_equal(shown, expected[..., : shown.shape[2]])


@pytest.fixture(scope="module")
def thumbnail(example: Callable[..., Path]) -> Path:
    """examples/thumbnail.c"""
    return example("thumbnail")


@pytest.mark.skipif(not shutil.which("pkg-config"), reason="needs pkg-config")
@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_the_example_of_a_window_draws_golden_streams(path: Path, thumbnail: Path, tmp_path: Path) -> None:
    """Pixels with alpha multiplied in; what has no colours is refused."""
    out = tmp_path / "out.bmp"
    done = subprocess.run([thumbnail, path, out, "80"], capture_output=True, text=True)
    with sgicodec.open(path) as stream:
        if stream.header.channels == "multi":
            assert (done.returncode, done.stderr.endswith("draw the channels\n")) == (1, True)
            return
        size = stream.width, stream.height
    assert (done.returncode, done.stdout, done.stderr) == (0, "{}×{} pixels\n".format(*size), "")
    data = out.read_bytes()
    shown = np.frombuffer(data[54:], np.uint8)
    columns, rows = np.frombuffer(data[18:26], "<i4")
    with Image.open(out) as image:
        assert image.size == (columns, -rows)
        assert max(image.size) == min(80, max(size))
        np.testing.assert_array_equal(np.asarray(image.convert("RGB")), shown.reshape(-rows, columns, 4)[..., 2::-1])


@pytest.mark.skipif(not shutil.which("pkg-config"), reason="needs pkg-config")
def test_all_memory_comes_from_operator_new(example: Callable[..., Path], tmp_path: Path) -> None:
    """With as little as it takes, and less, a call ends with a status, whatever it was doing."""
    program = example("decode", "bounded_memory")
    ends: dict[int, int] = {}
    for bound in (1, *(1 << n for n in range(10, 26))):
        command = [program, ROOT / "tests" / "conformance" / "golden" / "rgb8-tiles-texture.sgi", tmp_path / "out.ppm"]
        done = subprocess.run(command, env=os.environ | {"SGI_BYTES": str(bound)}, capture_output=True, text=True)
        ends[bound] = done.returncode
        assert done.returncode == 0 or done.stderr.endswith(": the system has no memory left\n")
    assert ends[1] == ends[1 << 16] == 1
    assert ends[1 << 25] == 0
    assert sorted(ends.values(), reverse=True) == list(ends.values())


CXX = ["c++", "-x", "c++", "-std=c++11"]


@pytest.mark.parametrize(
    ("compiler", "include"),
    [
        (["cc", "-x", "c", "-std=c99"], '#include "sgi.h"'),
        (CXX, '#include "sgi.h"'),
        (CXX, 'extern "C" {\n#include "sgi.h"\n}'),
    ],
)
def test_the_header_compiles_alone(compiler: list[str], include: str, tmp_path: Path) -> None:
    source = tmp_path / "use"
    source.write_text(
        f"{include}\nint main(void) {{\n"
        "  sgi_options options = SGI_OPTIONS_INIT;\n  sgi_info info = SGI_INFO_INIT;\n"
        "  sgi_view view = SGI_VIEW_INIT;\n"
        "  return (options.struct_size + info.struct_size + view.struct_size) == 0;\n}\n"
    )
    command = [*compiler, "-pedantic", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{HEADER.parent}", source]
    subprocess.run(command, check=True)


def test_cmake_finds_it(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.18)\nproject(user C)\nfind_package(sgi 1.0 REQUIRED)\n"
        f"add_executable(user {ROOT / 'examples' / 'decode.c'})\ntarget_link_libraries(user sgi::sgi)\n"
    )
    build = tmp_path / "build"
    subprocess.run(["cmake", "-S", tmp_path, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}"], check=True)
    subprocess.run(["cmake", "--build", build], check=True)
    assert subprocess.run([build / "user"]).returncode == 2


def test_the_layout_of_structures_is_that_of_the_first_version(library: Library, tmp_path: Path) -> None:
    """Fields may be added behind the last one; these stay where they are."""
    source = tmp_path / "layout.c"
    lines = ["#include <sgi.h>", "#include <stdio.h>", "int main(void) {"]
    kinds = {"sgi_options": Options, "sgi_info": Info, "sgi_view": View}
    for name, kind in kinds.items():
        lines.append(f'  printf("%zu\\n", sizeof({name}));')
        lines += [f'  printf("%zu\\n", offsetof({name}, {field[0]}));' for field in kind._fields_]
    source.write_text("\n".join([*lines, "  return 0;", "}"]))
    subprocess.run(["cc", f"-I{HEADER.parent}", source, "-o", tmp_path / "layout"], check=True)
    told = subprocess.run([tmp_path / "layout"], capture_output=True, text=True, check=True).stdout.split()
    expected = []
    for kind in kinds.values():
        expected += [ctypes.sizeof(kind), *(getattr(kind, field[0]).offset for field in kind._fields_)]
    assert [int(number) for number in told] == expected
