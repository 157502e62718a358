"""Writes streams whose metadata says how large a pixel is, on the ground or in a microscope: python measured.py DIR"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import rasterio
import tifffile
from rasterio.transform import from_origin

import sgicodec
from sgicodec import Picture
from sgicodec.metadata import ifd
from sgicodec.metadata.blobs import Metadata

SIDE = 96
PLACES = {
    "metres": (32633, from_origin(500000, 5800000, 10, 10)),
    "feet": (2263, from_origin(980000, 200000, 2, 2)),
    "mercator": (3857, from_origin(1500000, 8399737.89 + SIDE / 2 * 100, 100, 100)),
    "degrees": (4326, from_origin(13.0, 60.0 + SIDE / 2 / 3600, 1 / 3600, 1 / 3600)),
    "turned": (32633, from_origin(500000, 5800000, 30, 30) * rasterio.Affine.rotation(40)),
}
"""Name → EPSG code and transformation. The middle of "mercator" and "degrees" lies at 60° north."""


def main(folder: Path) -> None:
    """Encodes all of them."""
    x, y = np.meshgrid(np.arange(SIDE), np.arange(SIDE))
    pixels = np.stack([x * 2, y * 2, (x + y) % 64 * 3], axis=2).astype(np.uint8)
    with TemporaryDirectory() as scratch:
        for name, (code, transform) in PLACES.items():
            path = Path(scratch) / f"{name}.tif"
            profile = {"driver": "GTiff", "width": SIDE, "height": SIDE, "count": 3, "dtype": "uint8"}
            with rasterio.open(path, "w", **profile, crs=f"EPSG:{code}", transform=transform) as target:
                target.write(np.moveaxis(pixels, 2, 0))
            sgicodec.imwrite(folder / f"{name}.sgi", path, effort=1)
        density = {"resolution": (40000, 40000), "resolutionunit": "CENTIMETER"}
        print_density = {"resolution": (300, 300), "resolutionunit": "INCH"}
        for name, options in {"microns": density, "print": print_density}.items():
            path = Path(scratch) / f"{name}.tif"
            tifffile.imwrite(path, pixels, photometric="rgb", **options)
            sgicodec.imwrite(folder / f"{name}.sgi", path, effort=1)
    described = ifd.dump({270: ifd.Entry(2, b"Aperio Image Library v11\n96x96|AppMag = 20|MPP = 0.5040|Left = 1\0")}, 8)
    slide = Picture(pixels, "rgb", (0.0, 255.0), Metadata(exif=b"II*\0\x08\0\0\0" + described))
    sgicodec.imwrite(folder / "aperio.sgi", slide, effort=1)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
