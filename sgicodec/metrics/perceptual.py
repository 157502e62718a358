"""Measures made to agree with what people see: SSIMULACRA 2 and Butteraugli.

Both are optional: SSIMULACRA 2 comes with the package of that name (extra `bench`), Butteraugli with the command
`butteraugli_main` (Debian: libjxl-devtools). Both take 8-bit sRGB.
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import numpy.typing as npt

from sgicodec.errors import SgiError

__all__ = ["SMALLEST", "Perceived", "butteraugli", "perceived", "ssimulacra2"]

Rgb8 = npt.NDArray[np.uint8]  # [H, W, 3]

_COMMAND = "butteraugli_main"
SMALLEST = 8  # pixels; below, both give the best of values to any two pictures


@dataclass(frozen=True)
class Perceived:
    """ssimulacra2: up to 100, more is better; butteraugli: 3-norm of the distance, less is better. None: unknown."""

    ssimulacra2: float | None
    butteraugli: float | None

    @staticmethod
    def available() -> tuple[str, ...]:
        """The names of the measures that this machine can take."""
        found = {"ssimulacra2": find_spec("ssimulacra2"), "butteraugli": shutil.which(_COMMAND)}
        return tuple(name for name, where in found.items() if where)


def perceived(a: Rgb8, b: Rgb8) -> Perceived:
    """Both measures of two pictures; None for what is not installed, and where a side is under 8 pixels."""
    known = Perceived.available() if min(a.shape[:2]) >= SMALLEST else ()
    return Perceived(
        ssimulacra2(a, b) if "ssimulacra2" in known else None, butteraugli(a, b) if "butteraugli" in known else None
    )


def ssimulacra2(a: Rgb8, b: Rgb8) -> float:
    """SSIMULACRA 2 (Sneyers 2022, version 2.1) of `b` against the original `a`: 100 for equal ones, no lower end."""
    from ssimulacra2 import compute_ssimulacra2

    return float(compute_ssimulacra2(*(io.BytesIO(_ppm(pixels)) for pixels in (a, b))))


def butteraugli(a: Rgb8, b: Rgb8) -> float:
    """3-norm of the Butteraugli distance of `b` from the original `a`, as `butteraugli_main` of libjxl prints it.

    Raises SgiError if the command fails or prints something else.
    """
    with tempfile.TemporaryDirectory(prefix="sgi-butteraugli-") as folder:
        paths = [Path(folder, name) for name in ("a.ppm", "b.ppm")]
        for path, pixels in zip(paths, (a, b), strict=True):
            path.write_bytes(_ppm(pixels))
        done = subprocess.run([_COMMAND, *map(str, paths)], capture_output=True, text=True, check=False)
    norm = re.search(r"^3-norm: (\S+)$", done.stdout, re.MULTILINE)
    if done.returncode or norm is None:
        complaint = (done.stderr.strip().splitlines() or ["no 3-norm in what it prints"])[-1]
        raise SgiError(f"{_COMMAND} failed: {complaint}")
    return float(norm[1])


def _ppm(pixels: Rgb8) -> bytes:
    """The picture as a binary PPM."""
    return f"P6 {pixels.shape[1]} {pixels.shape[0]} 255\n".encode() + np.ascontiguousarray(pixels, np.uint8).tobytes()
