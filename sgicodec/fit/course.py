"""What the state of a fit foretells about its outcome: tables that `python -m sgicodec.bench.course` prints."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["DONE", "LAMBDAS", "POSITION_BITS", "STEPS", "course"]

DONE = (0.22, 0.24, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0)
"""Fractions of a fit; at the first, seeds were not dropped yet."""
LAMBDAS = (0.0012, 0.006, 0.03)
STEPS = (120, 350, 1000)
POSITION_BITS = 4.0
"""Of a seed, about."""

# [STEPS, LAMBDAS, DONE]: estimated bytes of the seeds over the stream's
_RATIO = np.array(
    [
        [
            [2.474, 1.509, 1.453, 1.257, 1.217, 1.198, 1.112, 1.103, 1.072, 1.065, 1.048],
            [3.248, 1.577, 1.386, 1.334, 1.233, 1.17, 1.062, 1.035, 0.987, 0.979, 1.008],
            [3.95, 1.561, 1.3, 1.149, 1.139, 1.063, 0.993, 0.964, 0.922, 0.917, 0.983],
        ],
        [
            [2.14, 1.279, 1.293, 1.23, 1.168, 1.117, 1.112, 1.098, 1.078, 1.072, 1.033],
            [2.327, 1.255, 1.301, 1.176, 1.065, 1.035, 1.03, 1.03, 1.022, 1.016, 1.004],
            [2.586, 1.036, 1.122, 1.057, 1.008, 1.003, 1.007, 0.99, 0.984, 0.981, 0.967],
        ],
        [
            [1.962, 1.147, 1.142, 1.117, 1.104, 1.083, 1.084, 1.063, 1.051, 1.038, 1.025],
            [2.032, 1.084, 1.058, 1.043, 1.032, 1.027, 1.025, 1.014, 1.014, 1.012, 0.989],
            [2.15, 1.035, 1.0, 1.006, 0.986, 0.99, 0.98, 0.98, 0.979, 0.977, 0.964],
        ],
    ]
)
# the same for PSNR under noise less the decoded picture's, dB
_LIFT = np.array(
    [
        [
            [-3.613, -3.599, -3.318, -2.713, -2.541, -1.888, -1.612, -1.095, -0.484, -0.079, 0.063],
            [-2.099, -2.75, -2.522, -1.984, -1.524, -1.332, -1.021, -0.855, -0.402, -0.075, 0.025],
            [-1.629, -2.437, -2.287, -1.625, -1.153, -1.116, -0.813, -0.614, -0.36, -0.086, 0.002],
        ],
        [
            [-3.357, -2.632, -2.325, -1.782, -1.455, -1.248, -1.311, -0.978, -0.281, 0.094, 0.154],
            [-2.74, -2.266, -1.822, -1.41, -1.077, -0.947, -0.793, -0.76, -0.223, 0.04, 0.103],
            [-1.982, -2.036, -1.606, -0.964, -0.739, -0.711, -0.585, -0.494, -0.154, 0.042, 0.043],
        ],
        [
            [-2.154, -1.602, -1.442, -1.153, -1.023, -0.928, -0.854, -0.78, -0.135, 0.148, 0.338],
            [-1.718, -1.195, -1.021, -0.728, -0.665, -0.594, -0.55, -0.518, -0.05, 0.117, 0.209],
            [-1.272, -0.863, -0.977, -0.566, -0.471, -0.38, -0.388, -0.341, -0.061, 0.064, 0.108],
        ],
    ]
)


def course(done: float, steps: int, lmbda: float) -> tuple[float, float]:
    """Ratio of bytes and difference of PSNR to expect when a fraction of so many steps at λ lies behind."""
    by_steps, by_lmbda = _weights(steps, STEPS), _weights(lmbda, LAMBDAS)
    both = np.outer(by_steps, by_lmbda)
    ratio, lift = (np.interp(done, DONE, np.tensordot(both, table, 2)) for table in (_RATIO, _LIFT))
    return float(ratio), float(lift)


def _weights(value: float, at: tuple[float, ...]) -> NDArray[np.float64]:
    """Of each entry, for linear interpolation over logarithms; what is beyond the ends is as at the ends."""
    return np.array([np.interp(math.log(value), np.log(at), row) for row in np.eye(len(at))])
