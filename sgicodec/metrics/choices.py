"""All distortions by name: what settings choose from."""

from __future__ import annotations

from sgicodec.metrics.distortion import Distortion
from sgicodec.metrics.squared_error import SquaredError
from sgicodec.metrics.weighted_squared_error import WeightedSquaredError

__all__ = ["DISTORTIONS"]

_ALL: tuple[Distortion, ...] = (SquaredError(), WeightedSquaredError())

DISTORTIONS: dict[str, Distortion] = {distortion.name: distortion for distortion in _ALL}
