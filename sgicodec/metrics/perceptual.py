"""Measures made to agree with what people see: SSIMULACRA 2, Butteraugli, FLIP, ColorVideoVDP, LPIPS and DISTS.

All are optional and take 8-bit sRGB. The encoder follows the first two, so that the others judge it better.
"""

from __future__ import annotations

import io
import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sgicodec.arrays import Rgb8
from sgicodec.errors import SgiError
from sgicodec.metrics.learned import learned_distance, network

_COMMAND = "butteraugli_main"


@dataclass(frozen=True)
class Perceived:
    """What the measures say of a picture; None where it is unknown."""

    ssimulacra2: float | None = None
    """Up to 100, more is better."""
    butteraugli: float | None = None
    """3-norm of the distance, less is better."""
    flip: float | None = None
    """Mean of the map, 0 to 1, less is better."""
    cvvdp: float | None = None
    """Up to 10 (just-objectionable differences), more is better."""
    lpips: float | None = None
    """A distance, less is better."""
    dists: float | None = None
    """0 to 1, less is better."""

    @staticmethod
    def available(side: float = math.inf) -> tuple[str, ...]:
        """The names of the measures that this machine can take of pictures whose shorter side has these pixels."""
        return tuple(name for name, each in _MEASURES.items() if side >= each.smallest and each.is_installed())


def perceived(a: Rgb8, b: Rgb8) -> Perceived:
    """All measures of two pictures; None for what is not installed, and of pictures that are too small for it."""
    return Perceived(**{name: _MEASURES[name].take(a, b) for name in Perceived.available(min(a.shape[:2]))})


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


def flip(a: Rgb8, b: Rgb8) -> float:
    """Mean of the FLIP map (Andersson et al. 2020) of `b` against the original `a`, at the 67 pixels per degree of its
    authors: 0 for equal ones.
    """
    from flip_evaluator import evaluate

    unit = (np.asarray(pixels, np.float32) / 255 for pixels in (a, b))
    return float(evaluate(*unit, "LDR", applyMagma=False)[1])


def cvvdp(a: Rgb8, b: Rgb8) -> float:
    """ColorVideoVDP (Mantiuk et al. 2024) of `b` against the original `a` on its display `standard_4k`: 10 for equal
    ones.
    """
    return float(_video_vdp().predict(b, a, dim_order="HWC")[0])


@cache
def _video_vdp() -> Any:
    from pycvvdp import cvvdp

    return cvvdp(display_name="standard_4k", quiet=True)


class _Measure(NamedTuple):
    """is_installed: whether this machine can take it; take: its value for an original and a decoded picture; smallest:
    the least pixels of a side. Below 8 SSIMULACRA 2 and Butteraugli give the best of values to any two pictures.
    """

    is_installed: Callable[[], bool]
    take: Callable[[Rgb8, Rgb8], float]
    smallest: int = 8


def _learned(name: str) -> _Measure:
    return _Measure(lambda: network(name) is not None, partial(learned_distance, name), 32)


def _has(module: str) -> Callable[[], bool]:
    return lambda: find_spec(module) is not None


_MEASURES = {
    "ssimulacra2": _Measure(_has("ssimulacra2"), ssimulacra2),
    "butteraugli": _Measure(lambda: shutil.which(_COMMAND) is not None, butteraugli),
    "flip": _Measure(_has("flip_evaluator"), flip),
    "cvvdp": _Measure(_has("pycvvdp"), cvvdp),
    "lpips": _learned("lpips"),
    "dists": _learned("dists"),
}
"""By the fields of `Perceived`. They come with the extras `bench` and `scores`, and Debian's libjxl-devtools."""


def _ppm(pixels: Rgb8) -> bytes:
    """The picture as a binary PPM."""
    return f"P6 {pixels.shape[1]} {pixels.shape[0]} 255\n".encode() + np.ascontiguousarray(pixels, np.uint8).tobytes()
