"""Builds libsgi below build/ and calls it through ctypes, as a program in another language would."""

from __future__ import annotations

import ctypes
import fcntl
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from data_files import GOLDEN, ROOT
from numpy.typing import NDArray

NEEDS_COMPILER = [
    pytest.mark.slow,
    pytest.mark.skipif(not shutil.which("cmake") or not shutil.which("cc"), reason="needs cmake and a C compiler"),
]
SAMPLES = ("uint8", "uint16", "float32")
STATUS = (
    *("ok", "usage", "region", "corrupt", "unsupported", "limit"),
    *("source", "memory", "internal", "stopped"),
)

Read = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_uint64, ctypes.c_void_p, ctypes.c_size_t)
Proceed = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)


def golden(name: str) -> bytes:
    """A golden stream."""
    return (GOLDEN / f"{name}.sgi").read_bytes()


def installed(name: str, **settings: str) -> Path:
    """Where libsgi is installed: build/NAME/prefix. Compiled anew where its sources changed; one process at a time."""
    folder = ROOT / "build" / name
    folder.mkdir(parents=True, exist_ok=True)
    prefix = folder / "prefix"
    given = {"SGI_PYTHON": "OFF", "Python_EXECUTABLE": sys.executable, "CMAKE_INSTALL_PREFIX": prefix} | settings
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        configure = [
            "cmake",
            *generator,
            "-S",
            ROOT,
            "-B",
            folder,
            *(f"-D{key}={value}" for key, value in given.items()),
        ]
        build = ["cmake", "--build", folder, "--parallel", str(os.cpu_count()), "--target", "install"]
        for command in (configure, build):
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            if done.returncode:
                raise RuntimeError(done.stdout[-4000:])
    return prefix


class Options(ctypes.Structure):
    """sgi_options"""

    _fields_ = (
        ("struct_size", ctypes.c_size_t),
        ("threads", ctypes.c_int),
        ("cache_bytes", ctypes.c_uint64),
        ("proceed", Proceed),
        ("proceed_user", ctypes.c_void_p),
        ("tile_bytes", ctypes.c_uint64),
    )


class Info(ctypes.Structure):
    """sgi_info"""

    _fields_ = (
        ("struct_size", ctypes.c_size_t),
        *((name, ctypes.c_uint32) for name in ("width", "height", "channels")),
        *((name, ctypes.c_int) for name in ("layout", "sample")),
        *((name, ctypes.c_float) for name in ("low", "high")),
        *((name, ctypes.c_uint32) for name in ("tiles", "tile_size")),
        ("has_nodata", ctypes.c_int),
        ("nodata", ctypes.c_double),
        ("has_overview", ctypes.c_int),
        ("levels", ctypes.c_uint32),
        ("file_bytes", ctypes.c_uint64),
    )


class View(ctypes.Structure):
    """sgi_view"""

    _fields_ = (
        ("struct_size", ctypes.c_size_t),
        *((name, ctypes.c_double) for name in ("x", "y", "width", "height")),
        *((name, ctypes.c_uint32) for name in ("columns", "rows")),
        *((name, ctypes.c_int) for name in ("sample", "boundless", "exact", "no_dither", "lossy")),
        *((name, ctypes.c_int) for name in ("pixels", "premultiplied")),
        *((name, ctypes.c_uint32) for name in ("first_row", "row_count")),
    )


class LibraryError(Exception):
    """A status that is not SGI_OK, by its name."""

    def __init__(self, status: str, text: str) -> None:
        super().__init__(text)
        self.status = status


class Library:
    """The functions of a shared libsgi; statuses other than SGI_OK are raised."""

    def __init__(self, path: Path) -> None:
        self.c = ctypes.CDLL(str(path))
        self.c.sgi_error.restype = self.c.sgi_version.restype = self.c.sgi_status_text.restype = ctypes.c_char_p
        self.c.sgi_close.argtypes = [ctypes.c_void_p]
        self.c.sgi_close.restype = None

    def call(self, name: str, *arguments: Any) -> None:
        """A function that returns a status."""
        status = getattr(self.c, name)(*arguments)
        if status:
            raise LibraryError(STATUS[status], self.c.sgi_error().decode())

    def probe(self, data: bytes) -> Info:
        """What the first bytes of a file say."""
        found = Info(ctypes.sizeof(Info))
        self.call("sgi_probe", data, ctypes.c_size_t(len(data)), ctypes.byref(found))
        return found

    def open(self, data: bytes, options: Options | None = None) -> Handle:
        """Opens a stream in memory."""
        handle = Handle(self, data)
        given = None if options is None else ctypes.byref(options)
        self.call("sgi_open_memory", data, ctypes.c_size_t(len(data)), given, ctypes.byref(handle.stream))
        return handle

    def open_callback(
        self, read: Callable[[int, int], bytes | int], size: int, options: Options | None = None
    ) -> Handle:
        """Opens what a function reads: bytes from an offset, at most a count; or the number that it returns in C."""

        def called(_: int, offset: int, buffer: int, count: int) -> int:
            found = read(offset, count)
            if isinstance(found, int):
                return found
            ctypes.memmove(buffer, found, len(found))
            return len(found)

        function = Read(called)
        handle = Handle(self, function)
        given = None if options is None else ctypes.byref(options)
        self.call("sgi_open", function, None, ctypes.c_uint64(size), given, ctypes.byref(handle.stream))
        return handle


class Handle:
    """An sgi_stream, closed with this object. `kept` lives as long."""

    def __init__(self, library: Library, kept: Any) -> None:
        self.library, self.kept, self.stream = library, kept, ctypes.c_void_p()

    def __del__(self) -> None:
        self.library.c.sgi_close(self.stream)

    def info(self) -> Info:
        found = Info(ctypes.sizeof(Info))
        self.library.call("sgi_get_info", self.stream, ctypes.byref(found))
        return found

    def level(self, level: int) -> tuple[int, int]:
        width, height = ctypes.c_uint32(), ctypes.c_uint32()
        out = ctypes.byref(width), ctypes.byref(height)
        self.library.call("sgi_get_level", self.stream, ctypes.c_uint32(level), *out)
        return width.value, height.value

    def range(self, channel: int) -> tuple[float, float]:
        low, high = ctypes.c_float(), ctypes.c_float()
        out = ctypes.byref(low), ctypes.byref(high)
        self.library.call("sgi_get_range", self.stream, ctypes.c_uint32(channel), *out)
        return low.value, high.value

    def max_error(self) -> float:
        found = ctypes.c_double()
        self.library.call("sgi_get_max_error", self.stream, ctypes.byref(found))
        return found.value

    def metadata(self, kind: int) -> bytes | None:
        data, size = ctypes.c_void_p(), ctypes.c_size_t()
        self.library.call("sgi_get_metadata", self.stream, kind, ctypes.byref(data), ctypes.byref(size))
        return None if data.value is None else ctypes.string_at(data, size.value)

    def draw_into(self, view: View, buffer: int | None, stride: int) -> None:
        address = None if buffer is None else ctypes.c_void_p(buffer)
        self.library.call("sgi_draw", self.stream, ctypes.byref(view), address, ctypes.c_size_t(stride))

    def view(self, **fields: Any) -> View:
        """Of the whole picture in samples of the source, unless the fields say something else."""
        info = self.info()
        whole = {"width": info.width, "height": info.height, "sample": info.sample} | fields
        size = {"columns": int(min(max(1, whole["width"]), 4096)), "rows": int(min(max(1, whole["height"]), 4096))}
        return View(ctypes.sizeof(View), **(size | whole))

    def draw(self, padding: int = 0, **fields: Any) -> NDArray[Any]:
        """Samples [rows, columns, C]; `padding` more in each row are there, and must not change."""
        view = self.view(**fields)
        channels, count = 4 if view.pixels else self.info().channels, view.row_count or view.rows - view.first_row
        rows = np.full((count, view.columns * channels + padding), 77, SAMPLES[view.sample])
        self.draw_into(view, rows.ctypes.data, rows.strides[0])
        assert (rows[:, view.columns * channels :] == 77).all()
        return rows[:, : view.columns * channels].reshape(count, view.columns, channels)

    def verify(self) -> int:
        crc = ctypes.c_uint32()
        self.library.call("sgi_verify", self.stream, ctypes.byref(crc))
        return crc.value
