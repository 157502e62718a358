"""A candidate: what a stream would hold, from a fit to the bytes of its payload."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.tile import TileModel, write_tile

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Fitted

__all__ = ["Candidate", "candidate_of", "written"]

_LEAST_TAUGHT = 64
"""Seeds from which on a fit may change the shipped context model; the change takes 20 to 250 bytes."""


@dataclass(frozen=True)
class Candidate:
    """What a stream would hold, and the λ that it was made for."""

    header: Header
    model: TileModel
    lmbda: float


def candidate_of(header: Header, fitted: Fitted, base_step: int, base: NDArray[np.int64]) -> Candidate:
    """A fit in integers, over a base layer in steps of an index. What few seeds teach the context model is noise, and
    costs more than they do.
    """
    shipped = header.spec.context.prior and len(fitted.layout) < _LEAST_TAUGHT
    networks = load_prior(header.spec) if shipped else fitted.networks
    model = TileModel(
        fitted.layout,
        fitted.plan,
        base_step,
        base,
        {name: np.rint(w * 2.0**fitted.decoder_shift).astype(np.int64) for name, w in fitted.decoders.items()},
        fitted.decoder_shift,
        networks,
        fitted.hash_bits,
        fitted.attributes,
    )
    return Candidate(replace(header, quality=fitted.quality), model, fitted.lmbda)


def written(candidate: Candidate) -> tuple[bytes, dict[str, float]]:
    """The payload of a model, and the bytes of each part."""
    payload, coder = write_tile(candidate.header, candidate.model)
    return payload, {name: bits / 8 for name, bits in coder.bits.items()}
