import hashlib
import math

import numpy as np
import pytest
from frequency_tables import FILE, SCALES, TABLES, TOTAL, frequency_tables
from symbols import SymbolReader, SymbolWriter, write_weights

SHA256 = "7e86137a6abd4543b53f667e7ca867ab8bba768232796e9b2458be738410b1e0"


def survival(table: int, x: float) -> float:
    """P(X > x), x ≥ 0, in float64: an independent check of integers made with 40 digits."""
    z = x / 2.0 ** ((table % SCALES - 24) / 6)  # docs/format.md, "Zero-centred tables"
    return math.erfc(z / math.sqrt(2)) / 2 if table < SCALES else math.exp(-math.sqrt(2) * z) / 2


def test_the_committed_file_is_the_specified_one() -> None:
    assert hashlib.sha256(FILE.read_bytes()).hexdigest() == SHA256


@pytest.mark.parametrize("table", range(TABLES))
def test_frequencies_are_the_distribution_rounded(table: int) -> None:
    frequency = frequency_tables().of_table[table]
    support = len(frequency) // 2 - 1
    assert frequency.sum() == TOTAL
    assert frequency.min() >= 1
    assert np.array_equal(frequency[:-1], frequency[-2::-1])
    tails = [survival(table, n + 0.5) for n in range(support + 1)]
    side = [TOTAL * (tails[n - 1] - tails[n]) for n in range(1, support + 1)]
    assert np.abs(frequency[support + 1 : -1] - np.maximum(side, 1)).max() <= 0.51
    assert abs(frequency[-1] - max(1, TOTAL * 2 * tails[support])) <= 0.51
    assert support == 511 or 2 * tails[support] < 2**-18


def test_a_writer_finds_the_family_and_scale_that_symbols_came_from() -> None:
    rng = np.random.default_rng(1)
    assert abs(best(np.rint(rng.normal(0, 4, 20000))) - 36) <= 1  # 2**((36 − 24) / 6) = 4
    assert abs(best(np.rint(rng.laplace(0, 4 / math.sqrt(2), 20000))) - (SCALES + 36)) <= 1
    assert best(np.zeros(0)) == 0


def best(symbols: np.ndarray) -> int:
    """The table that a writer chooses for them."""
    writer = SymbolWriter()
    write_weights(writer, symbols)
    return int(SymbolReader(writer.finish()).read_bits(7, 1)[0])
