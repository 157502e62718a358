"""What the benchmark learns of a codec, whether it runs in this process or as a command of its own."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from sgicodec.metrics.psnr import Pixels

Pixels8 = npt.NDArray[np.uint8]  # [H, W, 3]
Result = TypeVar("Result")

# A call this short is repeated, because the clock and the caches would decide its time.
_SHORT_SECONDS = 0.1
_REPEATS = 3


@dataclass(frozen=True)
class RoundTrip:
    """One picture encoded and decoded: the file's bytes, the pixels it gives, and what that took.

    `peak_mib` is the larger peak memory of the two processes in MiB; None where the codec runs in this
    process.
    """

    data: bytes
    pixels: Pixels8
    encode_seconds: float
    decode_seconds: float
    peak_mib: float | None = None


class Coded(NamedTuple):
    """One picture encoded and decoded within a greatest error: bytes, samples, and processor seconds, None where the
    system does not tell.
    """

    bytes: int
    pixels: Pixels
    encode_seconds: float | None
    decode_seconds: float | None


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """The result and the wall-clock seconds of `call`; the best of three runs when it is over at once."""
    best = float("inf")
    for _ in range(_REPEATS):
        start = time.perf_counter()
        result = call()
        best = min(best, time.perf_counter() - start)
        if best > _SHORT_SECONDS:
            break
    return result, best
