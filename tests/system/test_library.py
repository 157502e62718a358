"""libsgi as other programs use it: built, installed, found by pkg-config, called from C and through its interface."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest
from library import ROOT, SAMPLES, SIZE_UNKNOWN, Info, Library, LibraryError, Options, Proceed, View, installed
from mutate import mutated
from PIL import Image

import sgicodec
from sgicodec.errors import CorruptStreamError, LimitError, SgiError, UnsupportedStreamError

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not shutil.which("cmake") or not shutil.which("cc"), reason="needs cmake and a C compiler"),
]

GOLDEN = sorted((ROOT / "tests" / "conformance" / "golden").glob("*.sgi"))
HEADER = ROOT / "include" / "sgi.h"
METADATA = {"icc": 0, "exif": 1, "xmp": 2, "geo": 3}
STATUS_OF = {CorruptStreamError: "corrupt", UnsupportedStreamError: "unsupported", LimitError: "limit"}


def golden(name: str) -> bytes:
    return next(path for path in GOLDEN if path.stem == name).read_bytes()


@pytest.fixture(scope="session")
def prefix() -> Path:
    """Where the shared library is installed."""
    return installed("library")


@pytest.fixture(scope="session")
def library(prefix: Path) -> Library:
    """The shared library, loaded."""
    return Library(prefix / "lib" / "libsgi.so")


@pytest.fixture(scope="session")
def decoder(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """examples/decode.c, compiled as its first lines say."""
    program = tmp_path_factory.mktemp("example") / "decode"
    places = os.environ | {"PKG_CONFIG_PATH": str(prefix / "lib" / "pkgconfig")}
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "sgi"], env=places, capture_output=True, check=True)
    warnings = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Wno-missing-field-initializers"]
    command = ["cc", *warnings, ROOT / "examples" / "decode.c", *flags.stdout.decode().split(), "-o", program]
    subprocess.run([*command, f"-Wl,-rpath,{prefix / 'lib'}"], check=True)
    return program


@pytest.mark.skipif(not shutil.which("pkg-config"), reason="needs pkg-config")
@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_the_example_draws_golden_streams(path: Path, decoder: Path, tmp_path: Path) -> None:
    """What it writes is what `sgi decode` does."""
    out = tmp_path / "out.ppm"
    for options in [], ["0.6"]:
        subprocess.run([decoder, path, out, *options], check=True)
        shown = np.atleast_3d(np.asarray(Image.open(out)))
        with sgicodec.open(path) as stream:
            expected = stream.picture(size=(shown.shape[1], shown.shape[0]), dtype="uint8").pixels
        np.testing.assert_array_equal(shown, expected[..., : shown.shape[2]])


def test_the_example_says_what_is_wrong(decoder: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.sgi"
    damaged.write_bytes(golden("rgb8")[:-1])
    done = subprocess.run([decoder, damaged, tmp_path / "out.ppm"], capture_output=True, text=True)
    assert done.returncode == 1
    assert (
        done.stderr == f"{damaged}: the file ends inside chunk E at byte {len(golden('rgb8')) - 6}; it was cut short\n"
    )
    assert subprocess.run([decoder], capture_output=True).returncode == 2


@pytest.mark.parametrize("compiler", [["cc", "-x", "c", "-std=c99"], ["c++", "-x", "c++", "-std=c++11"]])
def test_the_header_compiles_alone(compiler: list[str], tmp_path: Path) -> None:
    source = tmp_path / "use"
    source.write_text('#include "sgi.h"\nint main(void) { return sgi_version()[0] == 0; }\n')
    command = [*compiler, "-pedantic", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{HEADER.parent}", source]
    subprocess.run(command, check=True)


def test_cmake_finds_it(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.18)\nproject(user C)\nfind_package(sgi 0.1 REQUIRED)\n"
        f"add_executable(user {ROOT / 'examples' / 'decode.c'})\ntarget_link_libraries(user sgi::sgi)\n"
    )
    build = tmp_path / "build"
    subprocess.run(["cmake", "-S", tmp_path, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}"], check=True)
    subprocess.run(["cmake", "--build", build], check=True)
    assert subprocess.run([build / "user"]).returncode == 2


def test_nothing_else_is_seen_from_outside(prefix: Path) -> None:
    listed = subprocess.run(
        ["nm", "-D", "--defined-only", prefix / "lib" / "libsgi.so"], capture_output=True, text=True, check=True
    )
    declared = set(re.findall(r"^SGI_API [^(]*?\b(sgi_\w+)\(", HEADER.read_text(), re.MULTILINE))
    assert {line.split()[-1] for line in listed.stdout.splitlines()} == declared
    assert len(declared) >= 12


def test_it_needs_neither_python_nor_zlib(prefix: Path) -> None:
    told = subprocess.run(["ldd", prefix / "lib" / "libsgi.so"], capture_output=True, text=True, check=True).stdout
    assert "libstdc++" in told
    assert not re.search(r"python|libz\.|nanobind", told)


def test_versions_agree(library: Library) -> None:
    version = library.c.sgi_version().decode()
    assert version == re.search(r'^version = "(.*)"', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[1]  # type: ignore[index]
    stated = dict(re.findall(r"#define SGI_VERSION_(\w+) (\d+)", HEADER.read_text()))
    assert version.split(".")[:2] == [stated["MAJOR"], stated["MINOR"]]


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


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_it_tells_and_draws_what_python_does(path: Path, library: Library) -> None:
    handle, info = library.open(path.read_bytes()), library.open(path.read_bytes()).info()
    with sgicodec.open(path) as stream:
        header = stream.header
        assert (info.width, info.height, info.channels) == (stream.width, stream.height, header.spec.channels)
        assert SAMPLES[info.sample] == header.sample_type
        np.testing.assert_array_equal([info.low, info.high], np.array(header.sample_range, np.float32))
        assert (info.tiles, info.tile_size) == (stream.grid.count, header.tile)
        assert info.has_nodata == (header.masked == "nodata")
        assert (info.has_overview, info.file_bytes) == (stream.has_overview, path.stat().st_size)
        assert [handle.level(level) for level in range(info.levels)] == [tuple(level[:2]) for level in stream.levels]
        for name, kind in METADATA.items():
            assert handle.metadata(kind) == getattr(stream.metadata, name)
        assert handle.verify() == stream.symbol_crc
        for dtype in SAMPLES:
            whole = handle.draw(sample=SAMPLES.index(dtype))
            np.testing.assert_array_equal(whole, stream.picture(dtype=dtype).pixels)
        x, y, width, height = min(5, info.width - 1), 0, max(1, info.width // 2 - 5), max(1, info.height // 3)
        for scale in (0.4, 1, 2.5):
            expected = stream.picture((x, y, width, height), scale=scale).pixels
            rows, columns = expected.shape[:2]
            size = {"x": x, "y": y, "width": width, "height": height, "columns": columns, "rows": rows}
            np.testing.assert_array_equal(handle.draw(padding=3, **size), expected)
        beyond = stream.picture((-3, -2, width + 9, height + 9), boundless=True).pixels
        size = {"x": -3, "y": -2, "width": width + 9, "height": height + 9}
        np.testing.assert_array_equal(handle.draw(boundless=1, **size), beyond)


def test_a_fraction_of_a_pixel_moves_the_picture(library: Library) -> None:
    """A region may begin between pixels: a view twice as fine has every second pixel of it."""
    handle = library.open(golden("rgb8"))
    fine = handle.draw(x=10, y=10, width=20, height=20, columns=40, rows=40, sample=2)
    moved = handle.draw(x=10.25, y=10.25, width=19.5, height=19.5, columns=39, rows=39, sample=2)
    np.testing.assert_allclose((fine[:-1, :-1] + fine[1:, 1:]) / 2, moved, atol=5e-4)
    assert np.abs(fine[:39, :39] - moved).max() > 2e-3


def test_sources_are_read_as_they_can_be(library: Library) -> None:
    data = golden("rgb8-tiles")
    expected = library.open(data).draw()
    reads: list[tuple[int, int]] = []

    def read(offset: int, count: int) -> bytes:
        reads.append((offset, count))
        return data[offset : offset + min(count, 1000)]  # fewer than it was asked for, as a pipe does

    np.testing.assert_array_equal(library.open_callback(read, len(data)).draw(), expected)
    assert max(offset + count for offset, count in reads) <= len(data)
    reads.clear()
    np.testing.assert_array_equal(library.open_callback(read, SIZE_UNKNOWN).draw(), expected)
    offsets = [offset for offset, _ in reads]
    assert offsets == sorted(offsets)


@pytest.mark.parametrize("returned", [-1, -(2**63), 2**62])
@pytest.mark.parametrize("after", [0, 1, 3])
def test_a_callback_that_fails_is_an_error_of_the_source(library: Library, returned: int, after: int) -> None:
    data = golden("rgb8-tiles")
    calls = []

    def read(offset: int, count: int) -> bytes | int:
        calls.append(offset)
        return data[offset : offset + count] if len(calls) <= after else returned

    with pytest.raises(LibraryError, match=r"reading failed at byte \d+") as caught:
        library.open_callback(read, len(data)).draw()
    assert caught.value.status == "source"


def test_a_file_that_shrinks_is_an_error_of_the_source(library: Library) -> None:
    data = golden("rgb8-tiles")
    with pytest.raises(LibraryError, match="reading failed") as caught:
        library.open_callback(lambda offset, count: data[: len(data) // 2][offset : offset + count], len(data)).draw()
    assert caught.value.status == "source"


def test_a_call_can_be_stopped(library: Library) -> None:
    data, calls = golden("rgb8-tiles"), []

    def proceed(_: int) -> int:
        calls.append(threading.get_ident())
        return len(calls) < stop

    stop = 10**9
    options = Options(ctypes.sizeof(Options), 0, 0, Proceed(proceed), None)
    expected = library.open(data, options).draw()
    assert len(calls) >= 2
    assert set(calls) == {threading.get_ident()}
    calls.clear()
    stop = 2
    handle = library.open(data, options)
    with pytest.raises(LibraryError, match="stopped") as caught:
        handle.draw()
    assert caught.value.status == "stopped"
    stop = 10**9
    np.testing.assert_array_equal(handle.draw(), expected)


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_a_tile_takes_no_more_than_it_may(path: Path, library: Library) -> None:
    """Enough changes nothing; too little is told, and less than that, too."""
    data = path.read_bytes()

    def draw(tile_bytes: int) -> np.ndarray:
        return library.open(data, Options(ctypes.sizeof(Options), tile_bytes=tile_bytes)).draw()

    expected = draw(0)
    for enough in (1 << 30, 2**64 - 1):
        np.testing.assert_array_equal(draw(enough), expected)
    for little in (1, 1000):
        with pytest.raises(LibraryError) as caught:
            draw(little)
        assert caught.value.status == "limit"


@pytest.mark.parametrize(
    ("name", "tile_bytes", "text"),
    [
        ("rgb8", 1 << 8, "base layer: values are 72; a tile holds at most 10"),
        ("rgb8", 1 << 20, "positions: more than 330 seeds"),
        ("rgb8-predicted-seeds", 1 << 20, "positions: more than 330 seeds"),
        ("rgb8-texture", 1 << 18, "samples with texture are 73728; a tile holds at most"),
    ],
)
def test_what_takes_too_much_is_named(library: Library, name: str, tile_bytes: int, text: str) -> None:
    with pytest.raises(LibraryError, match=text):
        library.open(golden(name), Options(ctypes.sizeof(Options), tile_bytes=tile_bytes)).draw()


def outcome_in_python(data: bytes) -> tuple[str, str] | np.ndarray:
    try:
        with sgicodec.open(data) as stream:
            if stream.width * stream.height * stream.header.spec.channels > 1 << 22:
                return "large", ""
            return stream.picture().pixels
    except SgiError as error:
        return STATUS_OF[type(error)], str(error)


def outcome_in_c(library: Library, data: bytes) -> tuple[str, str] | np.ndarray:
    try:
        return library.open(data).draw()
    except LibraryError as error:
        return error.status, str(error)


def test_damaged_streams_are_told_as_in_python(library: Library) -> None:
    """The same samples, or the same kind of error with the same words."""
    streams, rng, seen = [path.read_bytes() for path in GOLDEN], np.random.default_rng(3), set()
    for _ in range(150):
        data = mutated(streams[int(rng.integers(len(streams)))], streams, rng)
        expected = outcome_in_python(data)
        if isinstance(expected, tuple) and expected[0] == "large":
            continue
        seen.add(expected[0] if isinstance(expected, tuple) else "ok")
        found = outcome_in_c(library, data)
        if isinstance(expected, tuple) or isinstance(found, tuple):
            assert found == expected
        else:
            np.testing.assert_array_equal(found, expected)
    assert seen >= {"ok", "corrupt", "limit"}


WRONG_VIEWS = [
    ({"x": float("nan")}, "region", "too far away"),
    ({"width": float("inf")}, "region", "too far away"),
    ({"x": -1e300, "boundless": 1}, "region", "too far away"),
    ({"width": 0}, "region", "holds no picture"),
    ({"height": -4}, "region", "holds no picture"),
    ({"x": 1}, "region", r"region 1,0,192,128 is not inside the picture of 192×128 pixels"),
    ({"y": -0.5, "height": 20}, "region", "is not inside"),
    ({"width": 1e-300, "columns": 5}, "region", "is too small"),
    ({"columns": 0}, "usage", "no columns or no rows"),
    ({"rows": 0}, "usage", "no columns or no rows"),
    ({"columns": 2**32 - 1, "rows": 2**32 - 1}, "usage", "too many for one call"),
    ({"columns": 2**24 + 1, "rows": 1}, "usage", "too many for one call"),
    ({"columns": 2**16, "rows": 2**16}, "usage", "too many for one call"),
    ({"sample": 3}, "usage", "no sgi_sample"),
    ({"sample": -1}, "usage", "no sgi_sample"),
]


@pytest.mark.parametrize(("fields", "status", "text"), WRONG_VIEWS)
def test_views_that_make_no_sense_are_refused(
    library: Library, fields: dict[str, float], status: str, text: str
) -> None:
    handle, buffer = library.open(golden("rgb8")), np.zeros(1 << 16, np.float32)
    with pytest.raises(LibraryError, match=text) as caught:
        handle.draw_into(handle.view(**fields), buffer.ctypes.data, 2**40)
    assert caught.value.status == status
    assert not buffer.any()


@pytest.mark.parametrize(
    ("sample", "address", "stride", "text"),
    [
        (0, 0, 192 * 3 - 1, "a stride of 575 bytes; a row takes 576"),
        (1, 0, 192 * 3, "a row takes 1152"),
        (2, 0, 0, "a row takes 2304"),
        (1, 1, 2000, "multiples of the size of a sample"),
        (2, 2, 4000, "multiples of the size of a sample"),
        (2, 0, 4002, "multiples of the size of a sample"),
        (0, 0, 2**63 - 1, "larger than memory can be"),
        (0, 0, 2**64 - 1, "larger than memory can be"),
        (0, None, 576, "null pointer for the buffer"),
    ],
)
def test_buffers_that_make_no_sense_are_refused(
    library: Library, sample: int, address: int | None, stride: int, text: str
) -> None:
    handle, buffer = library.open(golden("rgb8")), np.zeros(1 << 16, np.float64)
    start = None if address is None else buffer.ctypes.data + address
    with pytest.raises(LibraryError, match=text) as caught:
        handle.draw_into(handle.view(sample=sample), start, stride)
    assert caught.value.status == "usage"
    assert not buffer.any()


def test_null_pointers_are_refused(library: Library) -> None:
    handle, data = library.open(golden("rgb8")), golden("rgb8")
    out, size, none = ctypes.c_void_p(5), ctypes.c_size_t(len(data)), ctypes.c_void_p()
    number = ctypes.c_uint32()
    calls = [
        ("sgi_open_memory", none, size, None, ctypes.byref(out)),
        ("sgi_open_memory", data, size, None, None),
        ("sgi_open", none, None, ctypes.c_uint64(5), None, ctypes.byref(out)),
        ("sgi_get_info", none, ctypes.byref(Info(ctypes.sizeof(Info)))),
        ("sgi_get_info", handle.stream, None),
        ("sgi_get_level", none, 0, ctypes.byref(number), ctypes.byref(number)),
        ("sgi_get_level", handle.stream, 0, None, ctypes.byref(number)),
        ("sgi_get_level", handle.stream, 0, ctypes.byref(number), None),
        ("sgi_get_metadata", none, 0, ctypes.byref(out), ctypes.byref(size)),
        ("sgi_get_metadata", handle.stream, 0, None, ctypes.byref(size)),
        ("sgi_get_metadata", handle.stream, 0, ctypes.byref(out), None),
        ("sgi_draw", none, ctypes.byref(handle.view()), ctypes.byref(number), ctypes.c_size_t(576)),
        ("sgi_draw", handle.stream, None, ctypes.byref(number), ctypes.c_size_t(576)),
        ("sgi_verify", none, ctypes.byref(number)),
    ]
    for name, *arguments in calls:
        with pytest.raises(LibraryError, match="null pointer") as caught:
            library.call(name, *arguments)
        assert caught.value.status == "usage", name
    assert out.value is None
    library.c.sgi_close(None)
    library.call("sgi_verify", handle.stream, None)
    assert library.c.sgi_is_stream(None, ctypes.c_size_t(8)) == 0


def test_sizes_of_structures_are_looked_at(library: Library) -> None:
    handle = library.open(golden("rgb8"))

    class Longer(ctypes.Structure):
        _fields_ = (("known", View), ("more", ctypes.c_uint64))

    def longer(more: int) -> Longer:
        found = Longer(handle.view(), more)
        found.known.struct_size = ctypes.sizeof(Longer)
        return found

    samples = np.empty((128, 192, 3), np.uint8)
    buffer = ctypes.c_void_p(samples.ctypes.data), ctypes.c_size_t(576)
    library.call("sgi_draw", handle.stream, ctypes.byref(longer(0)), *buffer)
    np.testing.assert_array_equal(samples, handle.draw())
    with pytest.raises(LibraryError, match="does not know"):
        library.call("sgi_draw", handle.stream, ctypes.byref(longer(1)), *buffer)
    for size in (0, 8, ctypes.sizeof(View) - 1, 4097, 2**63):
        view = handle.view()
        view.struct_size = size
        with pytest.raises(LibraryError, match=rf"sgi_view.struct_size is {size}; set it to sizeof\(sgi_view\)"):
            library.call("sgi_draw", handle.stream, ctypes.byref(view), *buffer)
        with pytest.raises(LibraryError, match="struct_size"):
            library.call("sgi_get_info", handle.stream, ctypes.byref(Info(size if size != 2**63 else 0)))
        with pytest.raises(LibraryError, match="struct_size"):
            library.open(golden("rgb8"), Options(size if size != ctypes.sizeof(View) - 1 else 12))
    larger = (ctypes.c_char * 200)(*[7] * 200)
    ctypes.memmove(larger, ctypes.byref(ctypes.c_size_t(200)), 8)
    library.call("sgi_get_info", handle.stream, ctypes.byref(larger))
    assert larger.raw[ctypes.sizeof(Info) :] == bytes(200 - ctypes.sizeof(Info))
    assert Info.from_buffer(larger).width == 192


def test_other_arguments_are_looked_at(library: Library) -> None:
    handle = library.open(golden("rgb8"))
    with pytest.raises(LibraryError, match="must not be negative"):
        library.open(golden("rgb8"), Options(ctypes.sizeof(Options), -1))
    for kind in (-1, 5):
        with pytest.raises(LibraryError, match="no kind of metadata"):
            handle.metadata(kind)
    with pytest.raises(LibraryError, match="level 1; there are 0 to 0") as caught:
        handle.level(1)
    assert caught.value.status == "region"
    out = ctypes.c_void_p(5)
    with pytest.raises(LibraryError, match="the file is empty"):
        library.call("sgi_open_memory", None, ctypes.c_size_t(0), None, ctypes.byref(out))
    assert out.value is None
    texts = {library.c.sgi_status_text(status) for status in range(-1, 12)}
    assert len(texts) == 11  # ten of them, and one for what is none
    for data, expected in ((golden("rgb8"), 1), (golden("rgb8")[:8], 1), (golden("rgb8")[:7], 0), (b"\x01\xda" * 8, 0)):
        assert library.c.sgi_is_stream(data, ctypes.c_size_t(len(data))) == expected


def test_an_error_is_that_of_a_thread_until_its_next_call(library: Library) -> None:
    handle = library.open(golden("rgb8"))
    with pytest.raises(LibraryError):
        handle.level(9)
    elsewhere: list[bytes] = []
    thread = threading.Thread(target=lambda: elsewhere.append(library.c.sgi_error()))
    thread.start()
    thread.join()
    assert elsewhere == [b""]
    assert library.c.sgi_error() == b"level 9; there are 0 to 0"
    handle.info()
    assert library.c.sgi_error() == b""


def test_threads_share_a_handle_and_draw_the_same(library: Library) -> None:
    """Of eight threads half share one handle with little memory, the others have their own."""
    data = golden("rgb8-tiles")
    expected = library.open(data).draw()
    shared = library.open(data, Options(ctypes.sizeof(Options), 2, 1))
    failures: list[str] = []

    def draw(index: int) -> None:
        handle = shared if index % 2 else library.open(data, Options(ctypes.sizeof(Options), 1 + index % 3))
        for turn in range(4):
            y = 16 * ((index + turn) % 6)
            part = handle.draw(y=y, height=32, columns=192, rows=32)
            if not np.array_equal(part, expected[y : y + 32]):
                failures.append(f"{index}, {turn}")

    threads = [threading.Thread(target=draw, args=(index,)) for index in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


def test_long_errors_are_cut_between_characters(library: Library) -> None:
    """A text has 511 bytes at most, and they are UTF-8."""
    handle = library.open(golden("rgb8"))
    with pytest.raises(LibraryError) as caught:
        handle.draw(x=1)
    assert "×" in str(caught.value)
    assert len(library.c.sgi_error()) < 512
