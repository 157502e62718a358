"""Step-size search: makes the steps of texture coarser or finer until a measured stream meets the target."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from sgicodec.rate_control.target import Measured, RateTarget

__all__ = ["OCTAVES_PER_UNIT", "SHIFT_MAX", "step_shift"]

MAX_STREAMS = 8
SHIFT_MAX = 96
"""32nds of an octave of the step, either way: three octaves."""
OCTAVES_PER_UNIT = -1 / 16
"""Octaves of λ that a unit of the shift stands for, until that is measured."""
RESOLUTION = 0.25
"""Of a shift. Between two steps, the price of bits moves as much as the step would."""
FIRST_MOVE_MAX = 24.0
"""Units of the shift in one move while the target lies beyond all streams."""
OVERSHOOT = 1.2


def step_shift(target: RateTarget, measure: Callable[[float], Measured]) -> float:
    """The shift of the steps, in 32nds of an octave, whose stream comes nearest to the target, of up to eight;
    `measure` makes a stream and measures it. Shifts are whole while there are such between two, then in quarters.

    A secant search between neighbours on both sides of the target: size and PSNR fall as the shift rises, by and large.
    A stream that misses the target is taken only if all do.
    """
    tried: dict[float, Measured] = {}
    shift: float | None = 0.0
    while shift is not None and len(tried) < MAX_STREAMS:
        tried[shift] = measure(shift)
        if target.is_met(tried[shift]):
            return shift
        shift = _next_shift({at: target.rate_error(measured) for at, measured in tried.items()})
    return list(tried)[target.nearest(list(tried.values()))]


def _next_shift(errors: dict[float, float]) -> float | None:
    """From the rate errors of the shifts that were tried, in their order; None where all have been tried."""
    ordered = sorted(errors)
    pairs = [pair for pair in pairwise(ordered) if (errors[pair[0]] > 0) != (errors[pair[1]] > 0)]
    if not pairs:
        return _beyond(errors)
    open_pairs = [(low, high) for low, high in pairs if high - low > RESOLUTION]
    if not open_pairs:
        return _next_to_best(errors)
    low, high = min(open_pairs, key=lambda pair: min(abs(errors[at]) for at in pair))
    unit = 1.0 if high - low > 1.0 else RESOLUTION
    part = errors[low] / (errors[low] - errors[high])
    sides = [error > 0 for error in errors.values()]
    if len(sides) > 2 and sides[-1] == sides[-2]:  # the secant creeps along one side of a jump
        part = 0.5
    return min(max(unit * round((low + part * (high - low)) / unit), low + unit), high - unit)


def _next_to_best(errors: dict[float, float]) -> float:
    """The untried shift next to the best one: where neighbours jump over the target, others may lie on it."""
    best = min(errors, key=lambda at: abs(errors[at]))
    return min(
        (at for away in range(-MAX_STREAMS, MAX_STREAMS + 1) if abs(at := best + away * RESOLUTION) <= SHIFT_MAX),
        key=lambda at: (at in errors, abs(at - best)),
    )


def _beyond(errors: dict[float, float]) -> float | None:
    """A shift beyond all that were tried, whose rate errors have one sign."""
    ordered, too_large = sorted(errors), next(iter(errors.values())) > 0
    last = ordered[-1] if too_large else ordered[0]
    slope = OCTAVES_PER_UNIT
    if len(errors) > 1:
        slope = (errors[ordered[-1]] - errors[ordered[0]]) / (ordered[-1] - ordered[0]) or OCTAVES_PER_UNIT
    move = -OVERSHOOT * errors[last] / min(slope, 0.3 * OCTAVES_PER_UNIT)
    moved = round(max(-FIRST_MOVE_MAX, min(FIRST_MOVE_MAX, move))) or (1 if too_large else -1)
    shift = max(-SHIFT_MAX, min(SHIFT_MAX, last + moved))
    return None if shift in errors else shift
