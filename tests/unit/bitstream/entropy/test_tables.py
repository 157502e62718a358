import hashlib
import math
from importlib.resources import files

import mpmath
import numpy as np
import pytest

from sgicodec.bitstream.entropy.tables import (
    MAX_MAGNITUDE,
    SCALES,
    TABLES,
    TOTAL,
    bernoulli_frequencies,
    frequency_tables,
)
from sgicodec.errors import UsageError
from tools.make_tables import SURVIVAL, make_table

SHA256 = "7e86137a6abd4543b53f667e7ca867ab8bba768232796e9b2458be738410b1e0"


def survival(table: int, x: float) -> float:
    """P(X > x), x ≥ 0, in float64: an independent check of integers made with 40 digits."""
    z = x / 2.0 ** ((table % SCALES - 24) / 6)  # docs/format.md, "Zero-centred tables"
    return math.erfc(z / math.sqrt(2)) / 2 if table < SCALES else math.exp(-math.sqrt(2) * z) / 2


def test_the_committed_file_is_the_specified_one() -> None:
    data = files("sgicodec.bitstream.entropy").joinpath("tables.bin").read_bytes()
    assert hashlib.sha256(data).hexdigest() == SHA256


@pytest.mark.parametrize("table", range(TABLES))
def test_frequencies_are_the_distribution_rounded(table: int) -> None:
    frequency = frequency_tables().frequencies(table)
    support = len(frequency) // 2 - 1
    assert frequency.sum() == TOTAL
    assert frequency.min() >= 1
    assert np.array_equal(frequency[:-1], frequency[-2::-1])
    tails = [survival(table, n + 0.5) for n in range(support + 1)]
    side = [TOTAL * (tails[n - 1] - tails[n]) for n in range(1, support + 1)]
    assert np.abs(frequency[support + 1 : -1] - np.maximum(side, 1)).max() <= 0.51
    assert abs(frequency[-1] - max(1, TOTAL * 2 * tails[support])) <= 0.51
    assert support == 511 or 2 * tails[support] < 2**-18


@pytest.mark.parametrize("table", [0, 24, 63, 64, 88, 127])
def test_the_script_makes_the_committed_integers(table: int) -> None:
    with mpmath.workdps(40):
        sigma = mpmath.mpf(2) ** (mpmath.mpf(table % SCALES - 24) / 6)
        half = make_table(SURVIVAL["laplace" if table >= SCALES else "gaussian"], sigma)
    frequency = frequency_tables().frequencies(table)
    assert half[:-1] == frequency[len(half) - 2 : -1].tolist()
    assert half[-1] == frequency[-1]


@pytest.mark.parametrize("family", sorted(SURVIVAL))
def test_every_family_of_the_script_has_unit_variance(family: str) -> None:
    tail = SURVIVAL[family]
    variance = mpmath.quad(lambda x: 4 * x * tail(x), [0, 1, 4, 16, mpmath.inf])
    assert abs(variance - 1) < 1e-9


def test_bits_are_minus_log2_of_the_frequencies() -> None:
    tables = frequency_tables()
    frequency = tables.frequencies(40)
    support = len(frequency) // 2 - 1
    expected = -np.log2(frequency / TOTAL)
    assert np.allclose(tables.bits(np.arange(-support, support + 1), 40), expected[:-1])
    # An escape, then Exp-Golomb of order 0 for |n| − S − 1 (1, 3, 3, 5 bits …) and a sign.
    beyond = support + 1 + np.array([0, 1, 2, 3, 6, 7])
    assert np.allclose(tables.bits(-beyond, 40), expected[-1] + np.array([1, 3, 3, 5, 5, 7]) + 1)
    assert np.isfinite(tables.bits(MAX_MAGNITUDE, 0))


def test_best_finds_the_family_and_scale_that_symbols_came_from() -> None:
    rng = np.random.default_rng(1)
    tables = frequency_tables()
    assert abs(tables.best(np.rint(rng.normal(0, 4, 20000))) - 36) <= 1  # 2**((36 − 24) / 6) = 4
    assert abs(tables.best(np.rint(rng.laplace(0, 4 / math.sqrt(2), 20000))) - (SCALES + 36)) <= 1
    assert tables.best(np.zeros(0)) == 0


@pytest.mark.parametrize("scale", [0.3, 5.0, 90.0, 900.0, 30_000.0])
def test_least_bits_are_those_under_the_best_table(scale: float) -> None:
    options = np.rint(np.random.default_rng(2).laplace(0, scale, (5, 4, 30))).astype(np.int64)
    options[3] //= 2
    tables = frequency_tables()
    every = np.stack([tables.bits(options, table).sum(axis=(1, 2)) for table in range(TABLES)])
    np.testing.assert_allclose(tables.least_bits(options), every.min(axis=0), rtol=1e-12)


def test_bernoulli_frequencies_are_midpoints() -> None:
    frequency = bernoulli_frequencies(np.arange(256))
    assert np.array_equal(frequency[:, 1] * 512, (2 * np.arange(256) + 1) * TOTAL)
    assert np.all(frequency.sum(axis=1) == TOTAL)
    assert np.array_equal(frequency, frequency[::-1, ::-1])


@pytest.mark.parametrize("code", [-1, 256])
def test_bernoulli_codes_out_of_range_are_refused(code: int) -> None:
    with pytest.raises(UsageError):
        bernoulli_frequencies(code)
