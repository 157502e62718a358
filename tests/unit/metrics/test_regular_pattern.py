"""Regular patterns: stripes are found with their strength and frequency, edges and noise are not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.metrics.regular_pattern import regular_patterns
from tests.support.scenes import ISAS

SHAPE = 96, 128
ROWS, COLUMNS = np.mgrid[: SHAPE[0], : SHAPE[1]]


def stripes(period: float, degrees: float, amplitude: float) -> NDArray[np.float64]:
    turn = np.radians(degrees)
    across = COLUMNS * np.cos(turn) + ROWS * np.sin(turn)
    return np.asarray(amplitude * np.sin(2 * np.pi * across / period))


@pytest.mark.parametrize("degrees", [0, 20, 45, 90, 135])
@pytest.mark.parametrize("period", [2.6, 3.0, 4.0, 6.0])
def test_stripes_are_found(period: float, degrees: float) -> None:
    found = regular_patterns(120 + stripes(period, degrees, 9.0))
    inner = np.s_[2:-2, 2:-2]
    assert found.certainty[inner].min() == 1
    np.testing.assert_allclose(found.deviation[inner], 9 / np.sqrt(2), rtol=0.1)
    np.testing.assert_allclose(found.frequency[inner], 2 / period, rtol=0.15)


@pytest.mark.parametrize("degrees", [0, 20, 45, 90])
def test_one_edge_is_no_pattern(degrees: float) -> None:
    turn = np.radians(degrees)
    edge = (COLUMNS - 64) * np.cos(turn) + (ROWS - 48) * np.sin(turn)
    plane = 60 + 120 / (1 + np.exp(-edge / 0.7))
    assert regular_patterns(plane).certainty.max() == 0


def test_a_block_depends_on_the_pixels_near_it() -> None:
    plane = stripes(4.0, 30, 8.0) + np.random.default_rng(4).normal(0, 4, SHAPE)
    whole, part = regular_patterns(plane), regular_patterns(plane[16:80, 32:112])
    np.testing.assert_allclose(part.certainty[1:-1, 1:-1], whole.certainty[3:9, 5:13], rtol=1e-5)


@pytest.mark.parametrize("isa", ISAS)
def test_numbers_follow_from_spectra(isa: str) -> None:
    """Of each block the pattern that stands out most, from the Fourier transform of the window around it."""
    rng, (height, width) = np.random.default_rng(5), SHAPE
    plane = (120 + stripes(3.7, 25, 6.0) * (COLUMNS > 60) + rng.normal(0, 3, SHAPE))[: height - 3, : width - 5]
    found = regular_patterns(plane, Device(1, isa))
    around = np.pad(plane, [(8, 24), (8, 24)], mode="symmetric")
    slope = np.sin(np.pi * (np.arange(24) + 0.5) / 24) ** 2
    window = np.outer(slope, slope) / (slope**2).sum()
    seen = 0
    for row, column in np.ndindex(found.certainty.shape):
        part = around[8 * row :][:24, 8 * column :][:, :24]
        level = (part * window).sum() / window.sum()
        ratio, power, frequency = most_regular(np.abs(np.fft.fft2((part - level) * window)) ** 2 * 2 / 24**2)
        certainty = min(max((ratio - 3) / 3, 0), 1)
        assert found.certainty[row, column] == pytest.approx(certainty, abs=1e-4)
        if certainty > 0.01:
            seen += 1
            assert found.deviation[row, column] == pytest.approx(np.sqrt(power), rel=1e-4)
            assert found.frequency[row, column] == pytest.approx(frequency / 12)
    assert seen > 20


def most_regular(power: NDArray[np.float64]) -> tuple[float, float, float]:
    """Ratio to what it is compared with, power, and cycles in a window of the pattern that stands out most."""
    values = np.array([power[v, u] for v, u in FREQUENCIES])
    own, others = OWN @ values, OTHERS @ values
    best = int(np.argmax(own / (others + 3)))
    return own[best] / (others[best] + 3), own[best], RADII[best]


FREQUENCIES = [(v, u) for v in range(-11, 12) for u in range(12) if u > 0 or v > 0]
PATTERNS = [(v, u) for v, u in FREQUENCIES if 3.9 <= np.hypot(v, u) <= 9.5]
RADII = [float(np.hypot(v, u)) for v, u in PATTERNS]


def is_own(pattern: tuple[int, int], at: tuple[int, int]) -> bool:
    """Whether a frequency belongs to a pattern's peak."""
    (v, u), (y, x) = pattern, at
    return bool(min(np.hypot(y - v, x - u), np.hypot(y + v, x + u)) <= 1.9)


def is_compared(pattern: tuple[int, int], at: tuple[int, int]) -> bool:
    """Whether a pattern's peak is compared with a frequency: an edge would have power there, or noise."""
    radius, away = np.hypot(*pattern), np.hypot(*at)
    turned = np.degrees(np.arctan2(*at) - np.arctan2(*pattern))
    turned = abs((turned + 90) % 180 - 90)
    in_line, around = away <= radius / 1.4 and turned < 27, abs(away - radius) <= 1.5 and turned > 30
    return bool(in_line or around) and not is_own(pattern, at)


OWN, OTHERS = (np.array([[of(p, at) for at in FREQUENCIES] for p in PATTERNS], float) for of in (is_own, is_compared))
"""[patterns, frequencies]"""
