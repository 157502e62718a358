"""The native context model against docs/format.md, "Context model", one seed at a time in Python's integers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sgicodec.device import ONE_THREAD
from sgicodec.model.layout import adaptive_layout
from sgicodec.model.native import SeedInputs, summarise
from sgicodec.profiles.default import default_spec

DETAIL = np.random.default_rng(0).normal(size=(3, 90, 150)) * np.linspace(0, 1, 150) ** 2
LAYOUT = adaptive_layout(DETAIL.astype(np.float32), 5.0)


def root(value: int, degree: int) -> int:
    """Floor of the degree-th root, exactly."""
    low, high = 0, 1 << (value.bit_length() // degree + 1)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle**degree <= value else (low, middle)
    return low


def amplitude_of(values: list[int]) -> int:
    """By the native code: `values` are the colours of the one Gaussian of one seed."""
    spec = default_spec(len(values))
    decoded = np.array([values + [0] * (spec.attributes - len(values))], np.int64)
    return int(summarise(spec, decoded, np.zeros(1, np.int64), ONE_THREAD)[1][0])


@pytest.mark.parametrize("offset", [-1, 0, 1, 2])
def test_amplitude_index_at_every_boundary(offset: int) -> None:
    """Energies on both sides of 2^(third / 3), as sums of squares."""
    for third in range(127):
        energy = max(1, root(2**third, 3) + offset)
        parts, rest = [], energy
        while rest:
            parts.append(min(math.isqrt(rest), 2**20))
            rest -= parts[-1] ** 2
        assert amplitude_of([part << 12 for part in parts]) == (energy**3).bit_length() - 73


def test_what_does_not_fit_is_refused() -> None:
    spec = default_spec(3)
    decoded = np.zeros((4, spec.attributes), np.int64)
    with pytest.raises(ValueError, match="indices of seeds"):
        summarise(spec, decoded, np.array([4]), ONE_THREAD)
    with pytest.raises(ValueError, match="do not fit"):
        summarise(replace(spec, channels=9), decoded, np.array([0]), ONE_THREAD)
    out, nobody = np.empty((1, 40), np.int16), np.full((1, 6), len(LAYOUT), np.int32)
    with pytest.raises(ValueError, match="indices of seeds"):
        SeedInputs(LAYOUT, 5, ONE_THREAD).write(np.array([0]), nobody, out)
