"""What a screen shows of the channels of a model, and gradients back from there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sgicodec.arrays import F32
from sgicodec.model.colours import to_samples
from sgicodec.model.spec import ModelSpec

_BEHIND = np.float32(0.5)
"""Samples behind what is transparent: a grey that tells dark and light colours from nothing."""


@dataclass(frozen=True)
class Screen:
    """spec: of the model; has_alpha: whether its last channel is opacity; alpha [H, W]: what that is, None where the
    model says so.
    """

    spec: ModelSpec
    has_alpha: bool = False
    alpha: F32 | None = None

    def shown(self, planes: F32) -> F32:
        """sRGB samples [C, H, W] of a model's channels; without alpha, where they have one."""
        samples = self._samples(planes)
        if not self.has_alpha:
            return samples
        shown: F32 = (samples[:-1] - _BEHIND) * self._opacity(samples) + _BEHIND
        return shown

    def gradient(self, planes: F32, shown: F32) -> F32:
        """The gradient in planes of what has this gradient in what is shown of them."""
        gradient = shown
        if self.has_alpha:
            samples = self._samples(planes)
            of_alpha = (shown * (samples[:-1] - _BEHIND)).sum(axis=0, keepdims=True)
            moves = (samples[-1:] > 0) & (samples[-1:] < 1) & (self.alpha is None)
            gradient = np.concatenate([shown * self._opacity(samples), of_alpha * moves])
        return np.tensordot(to_samples(self.spec).T.astype(np.float32), gradient, axes=1)

    def _opacity(self, samples: F32) -> F32:
        """[1, H, W], 0 to 1."""
        opacity: F32 = np.clip(samples[-1:], 0, 1) if self.alpha is None else self.alpha[None]
        return opacity

    def _samples(self, planes: F32) -> F32:
        """Samples of all channels."""
        return np.tensordot(to_samples(self.spec).astype(np.float32), planes, axes=1)
