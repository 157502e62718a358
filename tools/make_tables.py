"""Computes `tables.bin`. Run once per format version: `python -m tools.make_tables OUTPUT`.

A distribution of standard deviation σ steps is integrated over the unit bins [n − ½, n + ½] with 40 digits,
so that rounding to 24 bits has one possible outcome. f(n) = max(1, round(2**24 · P(n))) for 1 ≤ |n| ≤ S; the
escape takes the two tails beyond S; f(0) takes what rounding left over. S is the least support whose tails
weigh less than 2**-18, between 1 and 511.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import click
import mpmath  # type: ignore[import-untyped]
import numpy as np

FAMILIES = ("gaussian", "laplace")
SCALES = 64
"""Of a family; scale i stands for σ = 2^((i − 24) / 6) steps."""
TOTAL = 1 << 24
"""Sum of every table's frequencies."""
MAX_SUPPORT = 511
TAIL = mpmath.mpf(2) ** -18

Survival = Callable[[mpmath.mpf], mpmath.mpf]


def gaussian(x: mpmath.mpf) -> mpmath.mpf:
    """P(X > x) of the normal distribution with variance 1."""
    return mpmath.erfc(x / mpmath.sqrt(2)) / 2


def laplace(x: mpmath.mpf) -> mpmath.mpf:
    """P(X > x), x ≥ 0, of the Laplace distribution with variance 1."""
    return mpmath.exp(-mpmath.sqrt(2) * x) / 2


def logistic(x: mpmath.mpf) -> mpmath.mpf:
    """P(X > x) of the logistic distribution with variance 1."""
    return 1 / (1 + mpmath.exp(x * mpmath.pi / mpmath.sqrt(3)))


def mixture(x: mpmath.mpf) -> mpmath.mpf:
    """P(X > x) of two Gaussians of equal weight whose σ differ by 3, with variance 1 together."""
    narrow = mpmath.sqrt(mpmath.mpf(2) / (1 + 3**2))
    return (gaussian(x / narrow) + gaussian(x / (3 * narrow))) / 2


SURVIVAL: dict[str, Survival] = {
    "gaussian": gaussian,
    "laplace": laplace,
    "logistic": logistic,
    "mixture": mixture,
}
"""Upper tail P(X > x), x ≥ 0, of each distribution at standard deviation 1."""


def make_table(survival: Survival, sigma: mpmath.mpf) -> list[int]:
    """[f(0), …, f(S), f(escape)] of one distribution."""
    tails = [survival(mpmath.mpf(2 * n + 1) / (2 * sigma)) for n in range(MAX_SUPPORT + 1)]  # P(n > n + ½)
    support = next((s for s in range(1, MAX_SUPPORT) if 2 * tails[s] < TAIL), MAX_SUPPORT)
    side = [max(1, int(mpmath.nint(TOTAL * (tails[n - 1] - tails[n])))) for n in range(1, support + 1)]
    escape = max(1, int(mpmath.nint(TOTAL * 2 * tails[support])))
    return [TOTAL - 2 * sum(side) - escape, *side, escape]


def make_tables(families: tuple[str, ...] = FAMILIES) -> bytes:
    """The bytes of `tables.bin` (layout: docs/format.md, "Zero-centred tables")."""
    with mpmath.workdps(40):
        tables = [
            make_table(SURVIVAL[family], mpmath.mpf(2) ** (mpmath.mpf(i - 24) / 6))
            for family in families
            for i in range(SCALES)
        ]
    supports = np.array([len(table) - 2 for table in tables], "<u2")
    return supports.tobytes() + np.concatenate([np.array(table, "<u4") for table in tables]).tobytes()


@click.command()
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
def main(out: Path) -> None:
    """Write the tables to OUT and print their SHA-256."""
    content = make_tables()
    out.write_bytes(content)
    click.echo(f"{len(content)} bytes, SHA-256 {hashlib.sha256(content).hexdigest()}")


if __name__ == "__main__":
    main()
