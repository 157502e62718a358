"""NVRTC: kernels for one GPU's architecture, compiled at run time and kept in a cache on disk."""

from __future__ import annotations

import ctypes
import os
import tempfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from sgicodec.cuda import sources
from sgicodec.errors import MissingExtraError, NoDeviceError, SgiError

_NAMES = ("libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so")
_OPTIONS = ("-std=c++17", "-default-device", "-fmad=false", "-diag-suppress=161", "-diag-suppress=177")


class Compiler:
    """NVRTC from the extra `cuda`, else from a toolkit, of no later major version than `most`, the driver's. Raises
    MissingExtraError where there is none.
    """

    def __init__(self, most: int = 1 << 30) -> None:
        later = ""
        for name in (*_packaged(), *_NAMES):
            try:
                self._library = ctypes.CDLL(str(name))
            except OSError:
                continue
            self._library.nvrtcGetErrorString.restype = ctypes.c_char_p
            if int(self.version.split(".")[0]) <= most:
                return
            later = self.version
        if later:
            need = f"NVRTC {later} is later than the driver's CUDA {most}: update the driver"
            raise MissingExtraError(f"{need}, or pip install nvidia-cuda-nvrtc-cu{most}")
        raise MissingExtraError("CUDA needs NVRTC: pip install 'sgicodec[cuda]'")

    @property
    def version(self) -> str:
        """Such as 13.0."""
        major, minor = ctypes.c_int(), ctypes.c_int()
        self._call("nvrtcVersion", ctypes.byref(major), ctypes.byref(minor))
        return f"{major.value}.{minor.value}"

    @property
    def architectures(self) -> list[int]:
        """Those that it knows, the earliest first."""
        count = ctypes.c_int()
        self._call("nvrtcGetNumSupportedArchs", ctypes.byref(count))
        found = (ctypes.c_int * count.value)()
        self._call("nvrtcGetSupportedArchs", found)
        return sorted(found)

    def code(self, architecture: int) -> bytes:
        """Machine code for an architecture; for one that came after this compiler, PTX of the latest before it, which
        the driver compiles further.
        """
        if architecture in (known := self.architectures):
            return self.compile(f"sm_{architecture}", "CUBIN")
        if not (earlier := [one for one in known if one < architecture]):
            least, given = (f"{one // 10}.{one % 10}" for one in (known[0], architecture))
            raise NoDeviceError(f"a GPU of compute capability {given}; NVRTC {self.version} needs {least} or more")
        return self.compile(f"compute_{earlier[-1]}", "PTX")

    def compile(self, target: str, kind: str, *more: str) -> bytes:
        """What NVRTC makes of the kernels for a target such as sm_90: CUBIN, PTX or ProgramLog. more: options."""
        root, program = sources.root(), ctypes.c_void_p()
        text = (root / "cuda" / "kernels.cu").read_bytes()
        self._call("nvrtcCreateProgram", ctypes.byref(program), text, b"kernels.cu", ctypes.c_int(0), None, None)
        folders = (f"-I{place}" for place in (root, root / "native", root / "cuda" / "rtc"))
        options = [option.encode() for option in (f"-arch={target}", *_OPTIONS, *more, *folders)]
        try:
            given = (ctypes.c_char_p * len(options))(*options)
            if self._library.nvrtcCompileProgram(program, ctypes.c_int(len(options)), given):
                raise SgiError(f"NVRTC {self.version} does not compile the kernels for {target}: {self._log(program)}")
            return self._bytes(program, kind)
        finally:
            self._call("nvrtcDestroyProgram", ctypes.byref(program))

    def _log(self, program: ctypes.c_void_p) -> str:
        """The first error."""
        lines = self._bytes(program, "ProgramLog").rstrip(b"\0").decode(errors="replace").splitlines()
        return next((line for line in lines if "error" in line), "without saying why")

    def _bytes(self, program: ctypes.c_void_p, kind: str) -> bytes:
        size = ctypes.c_size_t()
        self._call(f"nvrtcGet{kind}Size", program, ctypes.byref(size))
        data = ctypes.create_string_buffer(size.value)
        self._call(f"nvrtcGet{kind}", program, data)
        return data.raw

    def _call(self, name: str, *arguments: Any) -> None:
        status = getattr(self._library, name)(*arguments)
        if status:
            raise SgiError(f"{name}: {self._library.nvrtcGetErrorString(status).decode()}")


def compiled(architecture: int, most: int, folder: Path | None = None) -> bytes:
    """The kernels for an architecture and a driver of CUDA `most`, from the cache in `folder` if they are there, else
    compiled into it.
    """
    folder = _cache_folder() if folder is None else folder
    compiler = the_compiler(most)
    name = sources.digest(f"{compiler.version} sm_{architecture} {_OPTIONS}")
    path = folder / f"{name[:32]}.cubin"
    try:
        return path.read_bytes()
    except OSError:
        pass
    code = compiler.code(architecture)
    _keep(path, code)
    return code


@cache
def the_compiler(most: int = 1 << 30) -> Compiler:
    """The compiler for a driver, loaded once in each process: it takes a tenth of a second."""
    return Compiler(most)


def _packaged() -> list[Path]:
    """NVRTC in NVIDIA's Python packages."""
    try:
        found = find_spec("nvidia")
    except (ImportError, ValueError):
        return []
    places = [] if found is None else list(found.submodule_search_locations or [])
    return sorted((path for place in places for path in Path(place).glob("*/lib/libnvrtc.so.*")), reverse=True)


def _cache_folder() -> Path:
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "sgicodec" / "cuda"


def _keep(path: Path, code: bytes) -> None:
    """Writes a file of the cache as a whole; where it cannot, the next process compiles again."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(code)
        os.replace(file.name, path)
    except OSError:
        pass
