"""Models that the format has and no profile."""

from __future__ import annotations

from dataclasses import replace

from sgicodec.model.spec import ModelSpec

__all__ = ["several"]


def several(spec: ModelSpec, per_seed: int) -> ModelSpec:
    """A model of the default profile with so many Gaussians in each seed."""
    return replace(spec, per_seed=per_seed, features=per_seed * (spec.channels + 3))
