"""Decodes streams in a process that cannot take much memory."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from children import HANGS
from sanitizer import needs_plain_memory

__all__ = ["printed", "read_with_little_memory"]

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
