"""Somebody who uses sgicodec for the first time: an empty home, and what they were told to install."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path


class Newcomer:
    """Runs commands in their home. With a wheel they have a new environment, else that of the tests."""

    def __init__(self, home: Path, wheel: Path | None) -> None:
        self.home = home
        self._wheel = wheel
        self._programs = Path(sys.executable).parent
        self._begun = self._installed = time.monotonic()

    def install(self, *packages: str) -> None:
        """Install the wheel, then the packages that a page names."""
        self._begun = time.monotonic()
        if self._wheel is not None:
            subprocess.run([sys.executable, "-m", "venv", self.home / "venv"], check=True)
            self._programs = self.home / "venv" / "bin"
            for asked in filter(None, ([self._wheel], packages)):
                subprocess.run([self._programs / "python", "-m", "pip", "-qq", "install", *asked], check=True)
        self._installed = time.monotonic()

    def run(self, *command: str | Path) -> str:
        """What a command prints. It sees nothing but their home and what is installed."""
        environment = {"HOME": str(self.home), "PATH": f"{self._programs}:/usr/local/bin:/usr/bin:/bin"}
        kept = {name: os.environ[name] for name in ("CHROMIUM",) if name in os.environ}
        done = subprocess.run(command, cwd=self.home, env=environment | kept, capture_output=True, text=True)
        assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
        return done.stdout

    def times(self) -> str:
        """Seconds since `install` began, and those that it took."""
        now = time.monotonic()
        return f"{now - self._begun:.1f} s, of which {self._installed - self._begun:.1f} s to install"
