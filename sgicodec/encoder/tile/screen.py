"""What a screen shows of the samples that a model has, and gradients back from there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.model.luma_space import from_luma_space

__all__ = ["Screen"]

F32 = NDArray[np.float32]

_BEHIND = np.float32(0.5)
"""Samples behind what is transparent: a grey that tells dark and light colours from nothing."""


@dataclass(frozen=True)
class Screen:
    """luma_space: whether the model's samples are in luma space; has_alpha: whether its last channel is opacity."""

    luma_space: bool = False
    has_alpha: bool = False

    def shown(self, planes: F32) -> F32:
        """sRGB samples [C, H, W] of planes as the model has them; without alpha, where they have one."""
        samples = self._plain(planes)
        if not self.has_alpha:
            return samples
        colours, alpha = samples[:-1], np.clip(samples[-1:], 0, 1)
        shown: F32 = (colours - _BEHIND) * alpha + _BEHIND
        return shown

    def gradient(self, planes: F32, shown: F32) -> F32:
        """The gradient in planes of what has this gradient in what is shown of them."""
        gradient = shown
        if self.has_alpha:
            samples = self._plain(planes)
            colours, alpha = samples[:-1], samples[-1:]
            moves = (alpha > 0) & (alpha < 1)
            of_alpha = (shown * (colours - _BEHIND)).sum(axis=0, keepdims=True) * moves
            gradient = np.concatenate([shown * np.clip(alpha, 0, 1), of_alpha])
        if not self.luma_space:
            return gradient
        return np.tensordot(from_luma_space(len(gradient)).T.astype(np.float32), gradient, axes=1)

    def _plain(self, planes: F32) -> F32:
        """Samples out of luma space."""
        if not self.luma_space:
            return planes
        return np.tensordot(from_luma_space(len(planes)).astype(np.float32), planes, axes=1)
