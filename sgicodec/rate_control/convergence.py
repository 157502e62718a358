"""Convergence table: predicts the outcome of a fit from its state (`python -m tools.convergence_table` measures it)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["DONE", "LMBDAS", "STEPS", "expected"]

DONE = (0.26, 0.28, 0.33, 0.36, 0.4, 0.46, 0.49, 0.55, 0.63, 0.66, 0.72, 0.76, 0.83, 0.87, 1.0)
"""Fractions of a fit; the first pruning of seeds lies between the first two."""
LMBDAS = (0.0012, 0.006, 0.03)
STEPS = (120, 350, 1000)

# [STEPS, LMBDAS, DONE]: estimated bytes of the seeds over the stream's
_BYTES_RATIO = np.array(
    [
        [
            [1.89, 1.35, 1.67, 1.73, 1.39, 1.28, 1.31, 1.18, 1.08, 1.18, 1.20, 1.12, 1.15, 1.08, 1.05],
            [2.16, 1.33, 1.68, 1.71, 1.32, 1.27, 1.31, 1.14, 1.06, 1.16, 1.18, 1.07, 1.12, 1.04, 1.02],
            [2.85, 1.17, 1.66, 1.62, 1.14, 1.14, 1.29, 1.04, 1.01, 1.13, 1.14, 1.04, 1.10, 1.01, 0.98],
        ],
        [
            [1.77, 1.24, 1.34, 1.34, 1.15, 1.19, 1.20, 1.12, 1.08, 1.18, 1.15, 1.11, 1.09, 1.10, 1.05],
            [2.21, 1.15, 1.34, 1.30, 1.09, 1.14, 1.16, 1.05, 1.03, 1.11, 1.09, 1.06, 1.06, 1.04, 1.02],
            [2.21, 1.03, 1.26, 1.18, 1.01, 1.03, 1.08, 1.00, 0.98, 1.07, 1.05, 1.01, 1.04, 1.01, 0.98],
        ],
        [
            [1.64, 1.16, 1.21, 1.18, 1.20, 1.18, 1.15, 1.07, 1.08, 1.07, 1.09, 1.04, 1.05, 1.06, 1.04],
            [1.92, 1.08, 1.13, 1.12, 1.11, 1.11, 1.09, 1.05, 1.03, 1.05, 1.07, 1.02, 1.03, 1.02, 1.01],
            [2.01, 1.05, 1.06, 1.06, 1.06, 1.04, 1.02, 1.03, 1.03, 1.02, 1.03, 1.01, 1.01, 1.01, 0.99],
        ],
    ]
)
# [STEPS, LMBDAS, DONE]: PSNR under noise less the decoded picture's, dB
_PSNR_OFFSET_DB = np.array(
    [
        [
            [-5.86, -5.19, -5.46, -4.40, -3.76, -3.02, -2.04, -2.75, -1.65, -2.21, -0.69, -0.69, -0.56, -0.06, 0.16],
            [-3.78, -3.96, -3.29, -2.52, -2.39, -2.01, -1.14, -1.57, -1.10, -1.08, -0.23, -0.41, -0.21, -0.02, 0.12],
            [-2.58, -3.39, -2.36, -1.87, -1.81, -1.31, -0.70, -0.99, -0.67, -0.65, -0.08, -0.28, -0.11, 0.05, 0.03],
        ],
        [
            [-3.38, -2.38, -3.90, -2.95, -2.27, -0.38, -2.99, -0.74, -0.62, -0.85, -0.49, -0.22, 0.07, 0.19, 0.31],
            [-2.38, -2.04, -2.21, -1.54, -1.67, -0.30, -1.22, -0.47, -0.34, -0.11, -0.27, -0.15, 0.16, 0.11, 0.22],
            [-1.79, -1.74, -1.15, -1.09, -0.96, -0.24, -0.52, -0.22, -0.24, -0.07, -0.10, -0.13, 0.12, 0.02, 0.09],
        ],
        [
            [-2.55, -1.73, -1.74, -1.25, -0.48, -0.35, -1.12, -0.84, -0.38, -0.54, -0.20, -0.13, 0.02, 0.31, 0.38],
            [-1.80, -1.17, -0.91, -0.63, -0.36, -0.24, -0.77, -0.37, -0.27, -0.17, 0.03, -0.02, 0.08, 0.19, 0.25],
            [-1.20, -0.66, -0.60, -0.38, -0.17, -0.14, -0.30, -0.10, -0.03, -0.08, 0.04, 0.11, 0.11, 0.18, 0.14],
        ],
    ]
)


def expected(done: float, steps: int, lmbda: float) -> tuple[float, float]:
    """Ratio of bytes and offset of PSNR in dB, state over outcome, after a fraction `done` of `steps` steps at λ."""
    both = np.outer(_weights(steps, STEPS), _weights(lmbda, LMBDAS))
    ratio, offset = (np.interp(done, DONE, np.tensordot(both, table, 2)) for table in (_BYTES_RATIO, _PSNR_OFFSET_DB))
    return float(ratio), float(offset)


def _weights(value: float, at: tuple[float, ...]) -> NDArray[np.float64]:
    """Of each entry, for linear interpolation over logarithms; beyond the ends the value at the end holds."""
    return np.array([np.interp(math.log(value), np.log(at), row) for row in np.eye(len(at))])
