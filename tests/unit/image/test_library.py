"""OpenImageIO's library is there before it is imported."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

_CODE = """
import sys
from pathlib import Path
from sgicodec.image.library import begin_to_load
thread = begin_to_load()
thread.join()
assert "OpenImageIO" not in sys.modules
assert "OpenImageIO" in Path("/proc/self/maps").read_text()
import OpenImageIO
assert begin_to_load() is None
"""


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="the system does not tell which libraries are loaded")
def test_loads_ahead_of_the_import() -> None:
    assert subprocess.run([sys.executable, "-c", _CODE], check=False).returncode == 0


def test_does_nothing_where_it_is_missing() -> None:
    code = "import sys; sys.modules['OpenImageIO'] = None; from sgicodec.image.library import begin_to_load\n"
    code += "sys.exit(begin_to_load() is not None)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
