"""Where tests find the repository, pictures and golden streams; parts of photographs, and files with a place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sgicodec import Picture, read

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "tests" / "data"
PICTURES, ATTACKS = DATA / "pictures", DATA / "attacks"
GOLDEN = ROOT / "tests" / "conformance" / "golden"
GOLDEN_STREAMS = sorted(GOLDEN.glob("*.sgi"))


def crop(name: str, part: tuple[slice, slice]) -> Picture:
    """A part of a photograph, such as crop("kodim23", np.s_[10:20, 30:40])."""
    photo = read(DATA / f"{name}.png")
    return replace(photo, pixels=np.ascontiguousarray(photo.pixels[part]))


def geotiff(path: Path, bands: np.ndarray, **profile: Any) -> Path:
    """A GeoTIFF of bands [C, H, W] in UTM, with pixels of ten metres, unless the profile says something else."""
    rasterio = pytest.importorskip("rasterio")
    count, height, width = bands.shape
    shape = {"count": count, "height": height, "width": width, "dtype": bands.dtype.name}
    place = {"crs": "EPSG:32632", "transform": rasterio.transform.from_origin(500000, 5400000, 10, 10)}
    with rasterio.open(path, "w", driver="GTiff", **shape, **place | profile) as file:
        file.write(bands)
    return path
