"""Opens and decodes streams in a process that cannot take much memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from children import HANGS

MEMORY = 1 << 30
"""Address space of the process that reads the lies: the libraries take a third of it."""

READER = """
import json, resource, sys
from pathlib import Path
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import SgiError
resource.setrlimit(resource.RLIMIT_AS, ({memory}, {memory}))
for path in sorted(Path({folder!r}).iterdir()):
    try:
        with open_stream(path) as stream:
            stream.picture()
        print(json.dumps([path.name, "picture", ""]))
    except SgiError as error:
        print(json.dumps([path.name, type(error).__name__, str(error)]))
"""


def needs_plain_memory() -> None:
    """Skips a test that bounds the address space, of which the sanitizer reserves terabytes."""
    if "libasan" in os.environ.get("LD_PRELOAD", ""):
        pytest.skip("AddressSanitizer reserves address space")


def printed(code: str) -> str:
    """What Python code prints that runs in a process of its own, with these paths and one thread of BLAS."""
    needs_plain_memory()
    environment = {"OPENBLAS_NUM_THREADS": "1", "PYTHONWARNINGS": "error", "PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=HANGS, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def read_with_little_memory(folder: Path) -> dict[str, tuple[str, str]]:
    """What became of each file in a process that cannot take more than MEMORY."""
    lines = printed(READER.format(memory=MEMORY, folder=str(folder))).splitlines()
    return {name: (kind, message) for name, kind, message in map(json.loads, lines)}


PROMISED = 64 << 20
"""Bytes beyond the interpreter and its libraries that a look at a hostile stream may take (docs/security.md)."""

LOOKS = """
import json, resource, sys
from pathlib import Path
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.errors import SgiError
looks = {{
    "survey": lambda stream: stream.survey().seeds,
    "region": lambda stream: stream.picture((5, 5, 40, 30)).pixels.shape,
    "scale": lambda stream: stream.picture(size=(12, 9)).pixels.shape,
    "enlarged": lambda stream: stream.picture(size=(9000, 9000)).pixels.shape,
    "overview": lambda stream: stream.overview.has_overview,
}}
with open_stream(Path({warm!r}).read_bytes(), Device(1)) as stream:
    looks["survey"](stream), looks["region"](stream), looks["scale"](stream)
pages = int(Path("/proc/self/statm").read_text().split()[0])
most = pages * resource.getpagesize() + {more}
resource.setrlimit(resource.RLIMIT_AS, (most, most))
found = {{}}
for name in {names!r}:
    try:
        with open_stream(Path({path!r}), Device(1)) as stream:
            found[name] = looks[name](stream)
    except SgiError as error:
        found[name] = f"{{type(error).__name__}}: {{error}}"
    except MemoryError:
        found[name] = "MemoryError"
print(json.dumps(found))
"""


def within(path: Path, warm: Path, *names: str, more: int = PROMISED) -> dict[str, object]:
    """What became of each look at a stream, within `more` bytes beyond what a look at the sound stream `warm` took."""
    code = LOOKS.format(path=str(path), warm=str(warm), names=names, more=more)
    result: dict[str, object] = json.loads(printed(code))
    return result
