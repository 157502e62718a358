"""The last step towards a size or a quality: all steps a little coarser or finer, measured on real streams."""

from __future__ import annotations

from collections.abc import Callable

from sgicodec.model.network import DIFFERENCE_SHIFT, IntNetwork
from sgicodec.rate_control.target import Measured, RateTarget

__all__ = ["MOST_SHIFT", "coarser", "trim"]

_MOST_TRIES = 8
MOST_SHIFT = 3 << DIFFERENCE_SHIFT
"""Of all steps, either way: three octaves."""
_FIRST_SLOPE = -0.01
"""log2 of the bytes for each unit of the shift, where nothing is known yet."""


def coarser(networks: tuple[IntNetwork, ...], shift: int) -> tuple[IntNetwork, ...]:
    """The networks with every refinement r of the steps raised by shift · 2^-DIFFERENCE_SHIFT octaves."""
    return tuple(network.coarser(shift) for network in networks)


def trim(goal: RateTarget, measure: Callable[[int], Measured]) -> int:
    """The shift whose stream comes nearest to the goal, of up to eight; `measure` makes a stream and measures it.

    Size and PSNR fall as the shift rises: a secant search. What misses the goal is taken only if all do.
    """
    tried: dict[int, Measured] = {}
    shift, slope = 0, _FIRST_SLOPE
    while shift not in tried and len(tried) < _MOST_TRIES:
        tried[shift] = measure(shift)
        if goal.is_met(tried[shift]):
            return shift
        excess = {at: goal.rate_error(measured) for at, measured in tried.items()}
        below = [at for at in excess if excess[at] > 0]  # too large or too good: must become coarser
        above = [at for at in excess if excess[at] <= 0]
        if below and above:
            low, high = max(below), min(above)
            part = excess[low] / (excess[low] - excess[high])
            shift = min(max(round(low + part * (high - low)), low + 1), high - 1)
        else:
            if len(excess) > 1:
                slope = (excess[max(excess)] - excess[min(excess)]) / (max(excess) - min(excess)) or _FIRST_SLOPE
            move = -excess[shift] / min(slope, 0.3 * _FIRST_SLOPE)
            shift += round(max(-24.0, min(24.0, 1.2 * move))) or (1 if excess[shift] > 0 else -1)
            shift = max(-MOST_SHIFT, min(MOST_SHIFT, shift))
    sound = [at for at, measured in tried.items() if not goal.is_missed(measured)]
    return min(sound or tried, key=lambda at: abs(goal.rate_error(tried[at])))
