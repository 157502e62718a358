"""Runs Python with the extension under AddressSanitizer and UBSan: python tests/support/sanitized.py -m pytest …

Compiles native/ into build/asan with checks that end the process (g++), and makes an environment there which sees the
libraries of this one, and the Python files of this tree where they lie. Leaks are not looked for: Python has its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "asan"

FINDER = """
import sys
from importlib.util import spec_from_file_location
class Finder:
    @staticmethod
    def find_spec(name, path=None, target=None):
        return spec_from_file_location(name, {extension!r}) if name == "sgicodec._native" else None
sys.meta_path.insert(0, Finder)
"""
OPTIONS = {
    "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1:handle_segv=1",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
}


def compiled() -> Path:
    """The extension, compiled anew where its sources changed."""
    import nanobind

    native = BUILD / "native"
    settings = {
        "SGI_SANITIZE": "ON",
        "SGI_PYTHON": "ON",
        "SGI_LIBRARY": "OFF",
        "CMAKE_BUILD_TYPE": "None",
        "Python_EXECUTABLE": sys.executable,
        "nanobind_DIR": nanobind.cmake_dir(),
    }
    subprocess.run(
        ["cmake", "-S", ROOT, "-B", native, *(f"-D{name}={value}" for name, value in settings.items())], check=True
    )
    subprocess.run(["cmake", "--build", native, "--parallel", str(os.cpu_count())], check=True)
    return next(native.glob("_native*.so"))


def environment(extension: Path) -> Path:
    """A Python that imports this extension, and all else from where this one does."""
    folder = BUILD / "venv"
    venv.create(folder, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    outside = [path for path in sys.path if path.endswith(("site-packages", "dist-packages", "/site"))]
    (site / "sanitized_finder.py").write_text(FINDER.format(extension=str(extension)))
    (site / "sanitized_finder.pth").write_text("\n".join([str(ROOT), *outside, "import sanitized_finder"]) + "\n")
    return folder / "bin" / "python"


def main() -> int:
    """Builds what is missing, then runs; returns the exit status."""
    python = environment(compiled())
    libraries = [
        subprocess.run(["g++", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so", "libstdc++.so")
    ]
    preload = {"LD_PRELOAD": ":".join(libraries), "PYTHONPATH": str(ROOT / "tests" / "support")}
    return subprocess.run([python, *sys.argv[1:]], env=os.environ | OPTIONS | preload, cwd=ROOT).returncode


if __name__ == "__main__":
    sys.exit(main())
