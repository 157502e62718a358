"""Bytes of a codec against another at each quality that their curves of all pictures reach."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sgicodec.bench.bdrate import Curve
from sgicodec.bench.confidence import interval

__all__ = ["Savings", "savings"]

F64 = npt.NDArray[np.float64]

_STEPS = 33


class Savings(NamedTuple):
    """qualities [n]; percent [n]: difference in bytes at each, from the mean of log-rates over pictures, negative is
    smaller; low, high [n]: ends of its confidence interval, not-a-number for too few pictures.
    """

    qualities: F64
    percent: F64
    low: F64
    high: F64


def savings(anchors: Mapping[str, Curve], tests: Mapping[str, Curve], within: tuple[float, float]) -> Savings | None:
    """What `tests` take against `anchors`, curves by picture, over the qualities `within` a range that all share; None
    where they share none.
    """
    pairs = [(anchors[name], tests[name]) for name in anchors if name in tests]
    curves = [curve for pair in pairs for curve in pair]
    if not curves or min(len(curve.qualities) for curve in curves) < 2:
        return None
    low = max(within[0], *(curve.qualities[0] for curve in curves))
    high = min(within[1], *(curve.qualities[-1] for curve in curves))
    if not low < high:
        return None
    qualities = np.linspace(low, high, _STEPS)
    ratios = np.array([test.log_rates_at(qualities) - anchor.log_rates_at(qualities) for anchor, test in pairs])
    return Savings(qualities, *(100 * np.expm1(each) for each in (ratios.mean(axis=0), *interval(ratios))))
