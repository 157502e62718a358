"""What an encode minimises besides bits: the contract of a distortion, and squared error between whole pictures.

A distortion turns a picture into a `Reference`. Every stage that decides on seeds asks that reference and nothing else
(texture and restoration minimise what an encode is tuned for: `encoder/tile/texture_steps.py`):

- `weights` is what one squared error costs at each pixel: it splits quadtree cells, prunes and adds seeds, is fused
  into the fit's native step and into RDOQ, and fits the base layer;
- `value` is what λ trades against bits, and what RDOQ judges whole models by.

A distortion that is no weighted sum of squares gives as `weights` those of a quadratic model of itself.

Weights have a mean of about 1 over photographs, so that λ and quality keep their meaning, and no other normalisation:
one error costs the same in every tile of a picture.

Masks: a pixel that holds nothing (`empty`) is filled with smooth colours before an encode, which must count as little
as the distortion allows; in reports, unseen colours (alpha 0) count nothing. PSNR is always plain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sgicodec.picture import Picture, to_unit

__all__ = ["Distortion", "QuadraticReference", "Reference", "decibels", "mean_weight", "squared_error"]

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]


class Reference(Protocol):
    """A picture as a distortion sees it. A residual [C, H, W] is the picture less what is rendered, samples in 0..1."""

    @property
    def weights(self) -> F32 | None:
        """Weight of the squared error at each pixel [H, W], above 0; None where all are 1, which takes faster code."""
        ...

    def value(self, residual: F32) -> float:
        """The distortion, in units of squared error summed over pixels and channels."""
        ...


class Distortion(Protocol):
    """A kind of distortion; `name` is what settings call it."""

    name: str

    def reference(self, picture: F32, empty: Mask | None = None) -> Reference:
        """The reference of a picture [C, H, W], samples in 0..1; pixels [H, W] where `empty` holds need not be shown.

        What it says of a pixel depends on the picture near this pixel alone, not on where tiles end farther away.
        """
        ...


@dataclass(frozen=True)
class QuadraticReference:
    """Σ w e² over pixels and channels; weights [H, W], or None for plain squared error."""

    weights: F32 | None = None

    def value(self, residual: F32) -> float:
        """Summed in float64."""
        squares = np.square(residual, dtype=np.float64)
        return float(np.sum(squares if self.weights is None else squares * self.weights))


def mean_weight(reference: Reference, residual: F32) -> float:
    """Distortion of a residual [C, H, W] over its squared error: what an error counts where this picture has detail."""
    plain = 0.0 if reference.weights is None else QuadraticReference().value(residual)
    return reference.value(residual) / plain if plain > 0 else 1.0


def squared_error(original: Picture, decoded: Picture, weights: F32 | None = None) -> float:
    """Squared error summed over samples in 0..1, times weights [H, W] if given; unseen colours count nothing."""
    error = 0.0
    for row in range(0, original.height, _ROWS):
        rows = slice(row, row + _ROWS)
        parts = (Picture(p.pixels[rows], p.channels, original.sample_range) for p in (original, decoded))
        ours, theirs = (to_unit(part) for part in parts)
        difference = ours.astype(np.float64) - theirs
        if original.alpha is not None:
            difference[ours[..., original.alpha] == 0, : original.alpha] = 0
        squares = difference**2
        error += float((squares if weights is None else squares * weights[rows, :, None]).sum())
    return error


def decibels(error: float, samples: int) -> float:
    """PSNR of this many samples with this squared error; infinite for none."""
    return 10 * math.log10(samples / error) if error > 0 else math.inf


_ROWS = 64
