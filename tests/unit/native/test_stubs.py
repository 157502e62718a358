"""The committed types of the extension are those of what was built."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import sgicodec

COMMITTED = Path(sgicodec.__file__).with_name("_native.pyi")


def test_stubs_are_up_to_date(tmp_path: Path) -> None:
    """Otherwise: make stubs."""
    fresh = tmp_path / "fresh.pyi"
    options = ["-q", "--exclude-values", "-m", "sgicodec._native", "-o", str(fresh)]
    subprocess.run([sys.executable, "-m", "nanobind.stubgen", *options], check=True)
    assert fresh.read_text("utf-8") == COMMITTED.read_text("utf-8")
