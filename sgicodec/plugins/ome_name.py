"""Names of OME-TIFF and OME-Zarr, known without what writes them."""

from __future__ import annotations

import re


def is_ome_name(name: str) -> bool:
    """Whether a file of this name is OME-TIFF."""
    return re.search(r"\.ome\.tiff?$", name, re.IGNORECASE) is not None


def is_zarr_name(name: str) -> bool:
    """Whether a folder of this name is Zarr."""
    return re.search(r"\.zarr[/\\]*$", name, re.IGNORECASE) is not None
