"""Seeds and texture in turn: each is searched for what the other leaves, until both have settled.

A fit does not see the texture that will lie over its seeds: it counts errors less where texture follows. Once texture
is there, what it leaves is known, and the symbols of seeds are searched again for that; then texture over them. What
texture rounds is left out, for it will be rounded anew.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.encoder.candidate import Candidate
from sgicodec.metrics.distortion import Reference
from sgicodec.rdoq import Rdoq, RdoqSettings

__all__ = ["with_settled_seeds"]

F32 = NDArray[np.float32]

DEARER = 1.4
"""λ of seeds that are searched again, in the λ of the encode."""
SETTINGS = RdoqSettings(passes=1, deep=7, rounds=4, coarser=0.0)
"""Other steps would move all values of seeds, which costs more than it gains."""


def with_settled_seeds(
    candidate: Candidate, left: F32, lmbda: float, device: Device, reference: Reference
) -> Candidate:
    """The candidate with its seeds' symbols searched once more for what is left to them [C, H, W]: the picture less all
    that is shown over them. lmbda: λ of the encode; reference: distortion of the picture.
    """
    price = DEARER * lmbda
    model = replace(candidate.model, texture=None, restoration=None)
    search = Rdoq(candidate.header, model, left, price, SETTINGS, device, reference)
    return replace(candidate, model=search.once(price))
