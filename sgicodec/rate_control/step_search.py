"""Step-size search: makes all steps a little coarser or finer until a measured stream meets the target."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

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


def step_shift(
    target: RateTarget,
    measure: Callable[[float], Measured],
    first_slope: float = FIRST_SLOPE,
    resolution: float = 1.0,
) -> float:
    """The shift of the step sizes, in units of 2^-DIFFERENCE_SHIFT octaves, whose stream comes nearest to the target,
    of up to eight; `measure` makes a stream and measures it. first_slope: octaves of λ that a unit stands for, until
    that is measured. resolution: what shifts are multiples of, which are whole while there are such between two.

    A secant search between neighbours on both sides of the target: size and PSNR fall as the shift rises, by and large.
    A stream that misses the target is taken only if all do.
    """
    tried: dict[float, Measured] = {}
    shift: float | None = 0.0
    while shift is not None and len(tried) < MAX_STREAMS:
        tried[shift] = measure(shift)
        if target.is_met(tried[shift]):
            return shift
        shift = _next_shift(
            {at: target.rate_error(measured) for at, measured in tried.items()}, first_slope, resolution
        )
    return list(tried)[target.nearest(list(tried.values()))]


def _next_shift(errors: dict[float, float], first_slope: float, resolution: float) -> float | None:
    """From the rate errors of the shifts that were tried, in their order; None where all have been tried."""
    ordered = sorted(errors)
    pairs = [pair for pair in pairwise(ordered) if (errors[pair[0]] > 0) != (errors[pair[1]] > 0)]
    if not pairs:
        return _beyond(errors, first_slope)
    open_pairs = [(low, high) for low, high in pairs if high - low > resolution]
    if not open_pairs:
        return _beside(errors, resolution)
    low, high = min(open_pairs, key=lambda pair: min(abs(errors[at]) for at in pair))
    unit = 1.0 if high - low > 1.0 else resolution
    part = errors[low] / (errors[low] - errors[high])
    sides = [error > 0 for error in errors.values()]
    if len(sides) > 2 and sides[-1] == sides[-2]:  # the secant creeps along one side of a jump
        part = 0.5
    return min(max(unit * round((low + part * (high - low)) / unit), low + unit), high - unit)


def _beside(errors: dict[float, float], resolution: float) -> float:
    """The untried shift next to the best one: where neighbours jump over the target, others may lie on it."""
    best = min(errors, key=lambda at: abs(errors[at]))
    return min(
        (at for away in range(-MAX_STREAMS, MAX_STREAMS + 1) if abs(at := best + away * resolution) <= SHIFT_MAX),
        key=lambda at: (at in errors, abs(at - best)),
    )


def _beyond(errors: dict[float, float], first_slope: float) -> float | None:
    """A shift beyond all that were tried, whose rate errors have one sign."""
    ordered, too_large = sorted(errors), next(iter(errors.values())) > 0
    last = ordered[-1] if too_large else ordered[0]
    slope = first_slope
    if len(errors) > 1:
        slope = (errors[ordered[-1]] - errors[ordered[0]]) / (ordered[-1] - ordered[0]) or first_slope
    move = -OVERSHOOT * errors[last] / min(slope, 0.3 * first_slope)
    moved = round(max(-FIRST_MOVE_MAX, min(FIRST_MOVE_MAX, move))) or (1 if too_large else -1)
    shift = max(-SHIFT_MAX, min(SHIFT_MAX, last + moved))
    return None if shift in errors else shift
