"""Where tests find the repository, pictures and golden streams; parts of photographs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from sgicodec import Picture, read

__all__ = ["ATTACKS", "DATA", "GOLDEN", "GOLDEN_STREAMS", "PICTURES", "ROOT", "crop"]

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "tests" / "data"
PICTURES, ATTACKS = DATA / "pictures", DATA / "attacks"
GOLDEN = ROOT / "tests" / "conformance" / "golden"
GOLDEN_STREAMS = sorted(GOLDEN.glob("*.sgi"))


def crop(name: str, part: tuple[slice, slice]) -> Picture:
    """A part of a photograph, such as crop("kodim23", np.s_[10:20, 30:40])."""
    photo = read(DATA / f"{name}.png")
    return replace(photo, pixels=np.ascontiguousarray(photo.pixels[part]))
