"""What the state of a fit foretells about its outcome: tables that `python -m sgicodec.bench.course` prints."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["DONE", "LAMBDAS", "POSITION_BITS", "STEPS", "course", "searched"]

DONE = (0.26, 0.28, 0.29, 0.32, 0.36, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0)
"""Fractions of a fit; seeds are dropped for the first time between the first two."""
LAMBDAS = (0.0012, 0.006, 0.03)
STEPS = (120, 350, 1000)
POSITION_BITS = 4.0
"""Of a seed, about."""

# [STEPS, LAMBDAS, DONE]: estimated bytes of the seeds over the stream's
_RATIO = np.array(
    [
        [
            [1.736, 1.266, 1.257, 1.273, 1.304, 1.228, 1.208, 1.168, 1.143, 1.123, 1.069],
            [1.908, 1.193, 1.203, 1.264, 1.280, 1.189, 1.154, 1.119, 1.098, 1.081, 1.032],
            [2.083, 1.047, 1.072, 1.193, 1.218, 1.112, 1.099, 1.063, 1.036, 1.025, 0.991],
        ],
        [
            [1.981, 1.205, 1.208, 1.213, 1.204, 1.156, 1.153, 1.120, 1.100, 1.090, 1.061],
            [1.984, 1.117, 1.146, 1.127, 1.129, 1.079, 1.082, 1.067, 1.061, 1.049, 1.012],
            [2.283, 1.031, 1.082, 1.082, 1.073, 1.026, 1.037, 1.029, 1.017, 1.013, 0.974],
        ],
        [
            [1.824, 1.158, 1.151, 1.160, 1.161, 1.122, 1.127, 1.114, 1.097, 1.058, 1.028],
            [1.879, 1.077, 1.087, 1.083, 1.095, 1.062, 1.064, 1.061, 1.047, 1.041, 0.995],
            [1.982, 1.043, 1.063, 1.055, 1.070, 1.018, 1.019, 1.018, 1.004, 1.000, 0.959],
        ],
    ]
)
# the same for PSNR under noise less the decoded picture's, dB
_LIFT = np.array(
    [
        [
            [-3.052, -3.081, -2.889, -2.276, -2.024, -1.787, -1.392, -0.984, -0.318, 0.077, 0.149],
            [-2.000, -2.610, -2.276, -1.723, -1.424, -1.385, -0.979, -0.738, -0.214, 0.137, 0.077],
            [-1.486, -2.591, -2.397, -1.477, -0.931, -1.068, -0.764, -0.521, -0.087, 0.060, 0.041],
        ],
        [
            [-2.393, -1.986, -1.832, -1.908, -1.341, -1.200, -1.198, -0.898, -0.256, 0.137, 0.248],
            [-1.988, -1.790, -1.544, -1.368, -0.978, -0.852, -0.841, -0.649, -0.159, 0.072, 0.160],
            [-1.325, -1.461, -1.237, -0.958, -0.764, -0.685, -0.582, -0.513, -0.123, 0.036, 0.027],
        ],
        [
            [-1.519, -1.112, -1.011, -1.023, -0.828, -0.825, -0.780, -0.682, -0.083, 0.230, 0.405],
            [-1.295, -0.960, -0.782, -0.643, -0.553, -0.522, -0.456, -0.500, 0.001, 0.173, 0.248],
            [-1.009, -0.638, -0.650, -0.497, -0.413, -0.377, -0.267, -0.258, 0.047, 0.127, 0.162],
        ],
    ]
)


# [STEPS, LAMBDAS]: what the search for symbols leaves of a stream's bytes, and adds to its PSNR, dB
_SHARE = np.full((3, 3), 0.965)
_GAIN = np.full((3, 3), 0.22)


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
