"""Tests an installed sgicodec away from its sources: python tests/support/installed.py. It needs pytest and hypothesis.

What is imported is what was installed: the tests are copied to where no package lies beside them.
"""

from __future__ import annotations

import runpy
import shutil
import signal
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
CHOSEN = ("conformance/golden", "conformance/test_suite.py", "unit/bitstream/test_container.py")
COMMANDS = (
    ("encode", "tests/data/pictures/hopper_gray.jpg", "one.sgi", "-e", "1", "-q", "20", "--quiet"),
    ("decode", "one.sgi", "one.png", "--quiet"),
    ("verify", "one.sgi"),
    ("info", "one.sgi"),
)


KERNELS = """
from sgicodec.cuda import sources
print(sources.root(), sources.digest(""), *sources._all_of("cuda/kernels.cu"), sep="\\n")
"""


def check_kernels(package: Path, place: Path, digest: str, names: list[str]) -> None:
    """Holds the kernels at `place`, with a digest of all that they include, by names, against those of this tree; they
    must lie in the package.
    """
    own = runpy.run_path(str(TESTS.parent / "sgicodec" / "cuda" / "sources.py"))
    expected: dict[str, str] = own["_all_of"]("cuda/kernels.cu")
    if package not in place.resolve().parents:
        sys.exit(f"the kernels are taken from {place}, not from what was installed")
    if missing := expected.keys() - names:
        sys.exit(f"the kernels lack {', '.join(sorted(missing))}")
    if digest != own["digest"](""):
        sys.exit("the kernels that were installed are others than those here")
    print(f"{len(names)} files of kernels are complete", flush=True)


PAGE = "from sgicodec.server.viewer import viewer_folder as page; assert page().name == 'web'; print(page())"


def check_viewing(folder: str, page: Path) -> None:
    """Has `sgi view` show a stream, and asks for all files of its page."""
    command = [sys.executable, "-m", "sgicodec", "view", "one.sgi", "--no-browser"]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        assert server.stdout is not None
        address = server.stdout.readline().strip().partition("/viewer/?")[0]

        def answer(path: str) -> bytes:
            with urllib.request.urlopen(f"{address}/{path}") as found:
                return bytes(found.read())

        try:
            files = [file for file in page.rglob("*") if file.is_file()]
            for file in files:
                if answer(f"viewer/{file.relative_to(page).as_posix()}") != file.read_bytes():
                    sys.exit(f"sgi view gives another {file}")
            if answer("files/one.sgi") != Path(folder, "one.sgi").read_bytes():
                sys.exit("sgi view gives another stream")
        finally:
            server.send_signal(signal.SIGINT)
    if server.returncode or not {"index.html", "page.js"} <= {file.name for file in files}:
        sys.exit(f"sgi view: exit code {server.returncode}, {len(files)} files")
    decoders = sum(file.suffix == ".wasm" for file in files)
    print(f"sgi view gives {len(files)} files of its page, {decoders} decoders among them", flush=True)


def main() -> int:
    """Returns 0 if all went well."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(TESTS, Path(folder, "tests"), ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(TESTS.parent / "pyproject.toml", folder)

        def python(*arguments: str) -> str:
            done = subprocess.run([sys.executable, *arguments], cwd=folder, stdout=subprocess.PIPE, text=True)
            print(done.stdout, end="", flush=True)
            done.check_returncode()
            return done.stdout

        try:
            place = python("-c", "import sgicodec; print(sgicodec.__file__)").strip()
            if TESTS.parent / "sgicodec" in Path(place).resolve().parents:
                sys.exit(f"{place} is the source, not what a wheel installs")
            kernels, digest, *names = python("-c", KERNELS).splitlines()
            check_kernels(Path(place).resolve().parent, Path(kernels), digest, names)
            page = Path(python("-c", PAGE).strip())
            for command in COMMANDS:
                python("-m", "sgicodec", *command)
            check_viewing(folder, page)
            python("-m", "pytest", "-p", "no:cacheprovider", *(f"tests/{name}" for name in CHOSEN))
        except subprocess.CalledProcessError as failed:
            return failed.returncode
    return 0


if __name__ == "__main__":
    sys.exit(main())
