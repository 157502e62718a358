"""Tests an installed sgicodec away from its sources: python tests/support/installed.py. It needs pytest and hypothesis.

What is imported is what was installed: the tests are copied to where no package lies beside them.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
CHOSEN = ("conformance/golden", "conformance/test_instruction_sets.py", "unit/bitstream/test_container.py")
COMMANDS = (
    ("encode", "tests/data/pictures/hopper_gray.jpg", "one.sgi", "-e", "1", "-q", "20", "--quiet"),
    ("decode", "one.sgi", "one.png", "--quiet"),
    ("verify", "one.sgi"),
    ("info", "one.sgi"),
)


def main() -> int:
    """Returns 0 if all went well."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(TESTS, Path(folder, "tests"), ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(TESTS.parent / "pyproject.toml", folder)

        def python(*arguments: str) -> str:
            done = subprocess.run(
                [sys.executable, *arguments], cwd=folder, stdout=subprocess.PIPE, text=True, check=True
            )
            print(done.stdout, end="", flush=True)
            return done.stdout

        try:
            place = python("-c", "import sgicodec; print(sgicodec.__file__)").strip()
            if TESTS.parent / "sgicodec" in Path(place).resolve().parents:
                sys.exit(f"{place} is the source, not what a wheel installs")
            python("-c", "from sgicodec.server.viewer import viewer_folder as page; assert page().name == 'web'")
            for command in COMMANDS:
                python("-m", "sgicodec", *command)
            python("-m", "pytest", "-p", "no:cacheprovider", *(f"tests/{name}" for name in CHOSEN))
        except subprocess.CalledProcessError as failed:
            return failed.returncode
    return 0


if __name__ == "__main__":
    sys.exit(main())
