"""Types of arrays by what they hold."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
Mask = NDArray[np.bool_]
Rgb8 = NDArray[np.uint8]
"""Samples [H, W, 3]."""
Samples = NDArray[Any]
"""Of a picture, of any type."""
