"""The sgi codec as a user meets it: the command line, on files, interpreter start included in every time."""

from __future__ import annotations

import hashlib
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution_version
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sgicodec.bench.codec import Coded, Pixels8, RoundTrip
from sgicodec.errors import SgiError, require
from sgicodec.metrics.psnr import Pixels

_PACKAGE = Path(__file__).resolve().parent.parent
_LAUNCHER = Path(__file__).with_name("peak.py")
# What cannot change a stream: the benchmark itself and sources that act only once compiled.
_INERT_SUFFIXES = {".pyc", ".cpp", ".hpp", ".cu", ".cuh"}


@dataclass(frozen=True)
class SgiCodec:
    """`sgi encode` at a ladder of qualities and one effort (None for the command's default), with further options."""

    ladder: tuple[float, ...] = (20.0, 35.0, 50.0, 65.0, 80.0)
    effort: int | None = None
    threads: int = 1
    command: tuple[str, ...] = (sys.executable, "-m", "sgicodec")
    label: str = ""
    options: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        parts = ["sgi", self.label, "" if self.effort is None else f"e{self.effort}"]
        return "-".join(part for part in parts if part)

    def version(self) -> str:
        """The distribution's version and a fingerprint of the code, so that no result outlives the code."""
        require("PIL", "the codec sgi in a benchmark", "bench")
        try:
            number = distribution_version("sgicodec")
        except PackageNotFoundError:
            number = "source"
        return f"{number}+{fingerprint(_PACKAGE)}"

    @property
    def fixed_settings(self) -> str:
        """All but the quality or the greatest error, in one line."""
        effort = "default" if self.effort is None else self.effort
        further = f" {shlex.join(self.options)}" if self.options else ""
        return f"effort={effort} threads={self.threads}{further}"

    def settings(self, quality: float) -> str:
        return f"quality={quality:g} {self.fixed_settings}"

    def round_trip(self, pixels: Pixels8, quality: float) -> RoundTrip:
        """See `trip`."""
        return self.trip(pixels, ("-q", f"{quality:g}"))

    def takes(self, pixels: Pixels, max_error: float) -> bool:
        """Whether samples can be brought back at all: always."""
        return True

    def coded(self, path: Path, pixels: Pixels, max_error: float) -> Coded:
        """Encode a file within a greatest error, without its metadata, decode to TIFF. Raises SgiError if a command
        fails.
        """
        from sgicodec.image.reader import read

        with tempfile.TemporaryDirectory(prefix="sgi-bench-") as folder:
            stream, result = Path(folder, "out.sgi"), Path(folder, "rec.tif")
            encoded, decoded = self._run(path, stream, result, ("--max-error", str(max_error), "--no-metadata"))
            return Coded(stream.stat().st_size, read(result).pixels, encoded.cpu, decoded.cpu)

    def trip(self, pixels: Pixels8, target: tuple[str, ...]) -> RoundTrip:
        """Write a PNG, encode it towards a target and decode by command, read the PNG. Raises SgiError if a command
        fails.
        """
        from PIL import Image

        with tempfile.TemporaryDirectory(prefix="sgi-bench-") as folder:
            source, stream, result = (Path(folder, name) for name in ("in.png", "out.sgi", "rec.png"))
            Image.fromarray(pixels).save(source, compress_level=1)
            encoded, decoded_by = self._run(source, stream, result, target)
            with Image.open(result) as picture:
                decoded = np.asarray(picture.convert("RGB"))
            peaks = [run.peak for run in (encoded, decoded_by) if run.peak is not None]
            return RoundTrip(
                stream.read_bytes(), decoded, encoded.seconds, decoded_by.seconds, max(peaks, default=None)
            )

    def _run(self, source: Path, stream: Path, result: Path, target: tuple[str, ...]) -> tuple[Run, Run]:
        """Both commands. Raises SgiError if one fails."""
        options = [*target, "-f", "--quiet", "--no-verify", "--threads", str(self.threads)]
        if self.effort is not None:
            options += ["-e", str(self.effort)]
        encoded = run_timed([*self.command, "encode", str(source), str(stream), *options, *self.options])
        return encoded, run_timed([*self.command, "decode", str(stream), str(result), "-f"])


def fingerprint(package: Path) -> str:
    """Eight hexadecimal digits of a hash of every file of the package that can change what is coded."""
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*")):
        inside = path.relative_to(package)
        if path.is_file() and inside.parts[0] != "bench" and path.suffix not in _INERT_SUFFIXES:
            digest.update(f"{inside.as_posix()}\0{path.stat().st_size}\0".encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:8]


class Run(NamedTuple):
    """A command that ended: wall-clock seconds, peak MiB and processor seconds, None where the system does not tell."""

    seconds: float
    peak: float | None
    cpu: float | None


def run_timed(command: Sequence[str]) -> Run:
    """Runs a command. Raises SgiError with its last line of complaint if it fails."""
    launched = [sys.executable, "-I", str(_LAUNCHER), *command]
    done = subprocess.run(launched, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode:
        complaint = [line for line in done.stderr.splitlines() if line.strip()] or ["it says nothing"]
        raise SgiError(f"`{' '.join(command)}` failed: {complaint[-1]}")
    seconds, *rest = done.stdout.split()
    peak, cpu = (None if value == "-" else float(value) for value in rest)
    return Run(float(seconds), peak, cpu)
