"""Step-size search: makes all steps a little coarser or finer until a measured stream meets the target."""

from __future__ import annotations

from collections.abc import Callable

from sgicodec.model.network import DIFFERENCE_SHIFT
from sgicodec.rate_control.target import Measured, RateTarget

__all__ = ["SHIFT_MAX", "step_shift"]

MAX_STREAMS = 8
SHIFT_MAX = 3 << DIFFERENCE_SHIFT
"""Of all steps, either way: three octaves."""
FIRST_SLOPE = -0.01
"""Octaves of λ by which a unit of the shift of attributes' steps changes the rate error, before it is measured."""
FIRST_MOVE_MAX = 24.0
"""Units of the shift in one move while the target lies beyond all streams."""
OVERSHOOT = 1.2


def step_shift(target: RateTarget, measure: Callable[[int], Measured], first_slope: float = FIRST_SLOPE) -> int:
    """The shift of the step sizes, in units of 2^-DIFFERENCE_SHIFT octaves, whose stream comes nearest to the target,
    of up to eight; `measure` makes a stream and measures it. first_slope: octaves of λ that a unit stands for, until
    that is measured.

    A secant search: size and PSNR fall as the shift rises. A stream that misses the target is taken only if all do.
    """
    tried: dict[int, Measured] = {}
    shift = 0
    while shift not in tried and len(tried) < MAX_STREAMS:
        tried[shift] = measure(shift)
        if target.is_met(tried[shift]):
            return shift
        shift = _next_shift({at: target.rate_error(measured) for at, measured in tried.items()}, shift, first_slope)
    return list(tried)[target.nearest(list(tried.values()))]


def _next_shift(errors: dict[int, float], shift: int, first_slope: float) -> int:
    """From the rate errors of the shifts that were tried, the last of them `shift`."""
    too_fine = [at for at in errors if errors[at] > 0]
    too_coarse = [at for at in errors if errors[at] <= 0]
    if too_fine and too_coarse:
        low, high = max(too_fine), min(too_coarse)
        part = errors[low] / (errors[low] - errors[high])
        sides = [error > 0 for error in errors.values()]
        if len(sides) > 2 and sides[-1] == sides[-2]:  # the secant creeps along one side of a jump
            part = 0.5
        return min(max(round(low + part * (high - low)), low + 1), high - 1)
    slope = first_slope
    if len(errors) > 1:
        slope = (errors[max(errors)] - errors[min(errors)]) / (max(errors) - min(errors)) or first_slope
    move = -OVERSHOOT * errors[shift] / min(slope, 0.3 * first_slope)
    moved = round(max(-FIRST_MOVE_MAX, min(FIRST_MOVE_MAX, move))) or (1 if errors[shift] > 0 else -1)
    return max(-SHIFT_MAX, min(SHIFT_MAX, shift + moved))
