"""What the state of a fit foretells about its outcome: tables that `python -m sgicodec.bench.course` prints."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["DONE", "LAMBDAS", "POSITION_BITS", "STEPS", "course", "searched"]

DONE = (0.26, 0.28, 0.33, 0.36, 0.4, 0.46, 0.49, 0.55, 0.63, 0.66, 0.72, 0.76, 0.83, 0.87, 1.0)
"""Fractions of a fit; seeds are dropped for the first time between the first two."""
LAMBDAS = (0.0012, 0.006, 0.03)
STEPS = (120, 350, 1000)
POSITION_BITS = 4.0
"""Of a seed, about."""

# [STEPS, LAMBDAS, DONE]: estimated bytes of the seeds over the stream's
_RATIO = np.array(
    [
        [
            [1.76, 1.22, 1.47, 1.51, 1.27, 1.23, 1.34, 1.19, 1.13, 1.25, 1.24, 1.12, 1.17, 1.11, 1.05],
            [1.87, 1.07, 1.50, 1.51, 1.17, 1.15, 1.30, 1.12, 1.06, 1.21, 1.20, 1.05, 1.13, 1.04, 1.02],
            [2.05, 0.99, 1.49, 1.56, 1.08, 1.10, 1.34, 1.06, 1.03, 1.26, 1.25, 1.02, 1.21, 1.02, 0.99],
        ],
        [
            [1.89, 1.16, 1.34, 1.33, 1.13, 1.14, 1.27, 1.14, 1.09, 1.19, 1.17, 1.08, 1.10, 1.07, 1.03],
            [2.07, 1.06, 1.27, 1.26, 1.05, 1.06, 1.22, 1.06, 1.03, 1.14, 1.13, 1.05, 1.08, 1.04, 1.00],
            [2.09, 0.97, 1.25, 1.21, 0.99, 1.01, 1.18, 1.01, 0.99, 1.13, 1.13, 1.00, 1.09, 1.00, 0.98],
        ],
        [
            [1.71, 1.11, 1.22, 1.20, 1.09, 1.09, 1.19, 1.08, 1.06, 1.12, 1.11, 1.06, 1.08, 1.05, 1.03],
            [1.82, 1.03, 1.13, 1.12, 1.02, 1.03, 1.12, 1.03, 1.02, 1.09, 1.08, 1.03, 1.06, 1.03, 1.00],
            [1.86, 0.99, 1.12, 1.12, 1.00, 1.01, 1.11, 1.01, 0.99, 1.07, 1.07, 1.00, 1.06, 1.01, 0.98],
        ],
    ]
)
# the same for PSNR under noise less the decoded picture's, dB
_LIFT = np.array(
    [
        [
            [-2.34, -2.69, -2.49, -2.01, -1.79, -1.25, -0.85, -1.05, -0.81, -0.53, -0.09, -0.01, 0.31, 0.26, 0.13],
            [-1.68, -2.43, -1.42, -1.11, -1.31, -0.88, -0.61, -0.71, -0.54, -0.23, 0.07, -0.02, 0.26, 0.15, 0.09],
            [-0.95, -2.00, -0.76, -0.46, -0.83, -0.53, -0.22, -0.45, -0.30, 0.03, 0.26, -0.01, 0.27, 0.11, 0.04],
        ],
        [
            [-2.28, -1.94, -1.72, -1.40, -1.23, -0.96, -1.71, -0.99, -0.67, -0.56, -0.05, 0.06, 0.27, 0.30, 0.22],
            [-1.73, -1.69, -1.13, -0.92, -0.93, -0.67, -0.80, -0.62, -0.41, -0.28, 0.07, 0.07, 0.24, 0.17, 0.14],
            [-1.12, -1.38, -0.63, -0.60, -0.60, -0.45, -0.45, -0.36, -0.29, -0.11, 0.16, 0.04, 0.20, 0.11, 0.05],
        ],
        [
            [-1.39, -1.09, -0.94, -0.74, -0.72, -0.63, -0.81, -0.57, -0.39, -0.24, 0.08, 0.14, 0.29, 0.28, 0.31],
            [-1.20, -0.97, -0.67, -0.58, -0.57, -0.47, -0.52, -0.45, -0.30, -0.16, 0.10, 0.11, 0.25, 0.21, 0.22],
            [-0.81, -0.79, -0.35, -0.31, -0.42, -0.36, -0.26, -0.30, -0.23, -0.03, 0.15, 0.07, 0.20, 0.12, 0.09],
        ],
    ]
)
# [STEPS, LAMBDAS]: what the search for symbols leaves of a stream's bytes, and adds to its PSNR, dB
_SHARE = np.array([[0.965, 0.972, 0.979], [0.958, 0.969, 0.972], [0.950, 0.955, 0.956]])
_GAIN = np.array([[0.711, 0.527, 0.331], [0.512, 0.413, 0.246], [0.526, 0.377, 0.228]])


def course(done: float, steps: int, lmbda: float) -> tuple[float, float]:
    """Ratio of bytes and difference of PSNR to expect when a fraction of so many steps at λ lies behind."""
    by_steps, by_lmbda = _weights(steps, STEPS), _weights(lmbda, LAMBDAS)
    both = np.outer(by_steps, by_lmbda)
    ratio, lift = (np.interp(done, DONE, np.tensordot(both, table, 2)) for table in (_RATIO, _LIFT))
    return float(ratio), float(lift)


def searched(steps: int, lmbda: float) -> tuple[float, float]:
    """What a search for symbols leaves of the bytes after a fit of so many steps at λ, and adds to PSNR in dB."""
    both = np.outer(_weights(steps, STEPS), _weights(lmbda, LAMBDAS))
    return float(np.sum(both * _SHARE)), float(np.sum(both * _GAIN))


def _weights(value: float, at: tuple[float, ...]) -> NDArray[np.float64]:
    """Of each entry, for linear interpolation over logarithms; what is beyond the ends is as at the ends."""
    return np.array([np.interp(math.log(value), np.log(at), row) for row in np.eye(len(at))])
