"""How far a mean over pictures may be trusted: bootstrap intervals."""

from __future__ import annotations

import math
import warnings

import numpy as np

from sgicodec.arrays import F64

LEVEL = 0.95
"""Share of such intervals that hold the mean of the population."""

MIN_PICTURES = 3
"""Below, pictures drawn anew from so few say nothing."""

_RESAMPLES = 2000


def interval(values: F64) -> tuple[F64, F64]:
    """Lower and upper end [...] of the interval of the mean of `values` [pictures, ...], taken as a random sample.

    Bias-corrected and accelerated bootstrap (Efron 1987), with a fixed seed: equal values give equal ends. Not-a-number
    where there are less than `MIN_PICTURES`; the value itself where all are equal.
    """
    from scipy.stats import bootstrap

    if len(values) < MIN_PICTURES:
        nothing = np.full(values.shape[1:], math.nan)
        return nothing, nothing
    options = {"n_resamples": _RESAMPLES, "confidence_level": LEVEL, "method": "BCa"}
    with warnings.catch_warnings(action="ignore"):  # of values that are all equal
        found = bootstrap(
            (values,), np.mean, axis=0, random_state=np.random.default_rng(0), **options
        ).confidence_interval
    is_equal = np.ptp(values, axis=0) == 0
    low, high = (np.where(is_equal, values[0], end) for end in (found.low, found.high))
    return low, high
