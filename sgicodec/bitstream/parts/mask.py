"""Masks: which pixels hold nothing (docs/format.md, "Masks")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec._native import max_mixed
from sgicodec.errors import PictureError


def write_mask(mask: NDArray[np.bool_]) -> bytes:
    """The payload of a mask [h, w]. Raises PictureError for one of more mixed squares than a reader takes."""
    height, width = mask.shape
    payload, mixed = _native.write_mask(mask.view(np.uint8))
    if mixed > max_mixed(len(payload)):
        text = "it alternates between pixels with and without content in too many places"
        raise PictureError(f"{width}×{height} pixels are too many for the mask of one tile: {text}; choose --tile 1024")
    return payload
