"""Quality search: which quality makes a stream that meets a target. Streams of few steps come first, since a quality
spends nearly the same at every effort.
"""

from __future__ import annotations

from collections.abc import Callable

from sgicodec.rate_control.target import RateTarget

_FIRST_QUALITY = 50.0
MIN_QUALITY, MAX_QUALITY = -23.0, 146.0
"""Where λ is 4 and 2 · 10^-6: beyond what a user may name, for targets that lie there."""
QUALITY_PER_OCTAVE = 8.0
"""Steps of quality that halve λ."""
_MAX_DRAFTS, MAX_STREAMS = 3, 12
_NEAR, _MAX_MOVE = 3.0, 48.0
"""Steps of quality between two drafts below which no other is worth its time, and the most from one stream to the next
while the target lies beyond all."""
_RESOLUTIONS = 0.05, 0.01
"""Qualities that are tried are multiples of these: of the second where that of the first was tried already."""
_MIN_SLOPE, _MAX_SLOPE = 1 / 24, 1 / 3
"""Octaves of λ that a step of quality is taken for."""

Measure = Callable[[float], float]
"""What the stream of a quality has of the quantity that its target is about."""


def searched_quality(
    target: RateTarget,
    measure: Measure,
    draft: Measure | None = None,
    ending: Callable[[], bool] = lambda: False,
) -> float:
    """The quality of the stream that comes nearest to the target, of those that `measure` makes, twelve at most; one
    that misses the target only if all do. draft: makes streams of less effort, None for none;
    ending: whether to end soon.
    """
    quality, slope = _FIRST_QUALITY, 1 / QUALITY_PER_OCTAVE
    drafts: dict[float, float] = {}
    while draft is not None and len(drafts) < _MAX_DRAFTS and not ending():
        drafts[quality] = target.rate_error(draft(quality))
        before, quality = quality, _next_quality(drafts, slope)
        if len(drafts) > 1:
            slope = _slope(drafts)
        if abs(quality - before) < _NEAR:
            break
    tried: dict[float, float] = {}
    while quality not in tried and len(tried) < MAX_STREAMS:
        tried[quality] = measure(quality)
        if target.is_met(tried[quality]) or ending():
            return quality
        errors = {at: target.rate_error(measured) for at, measured in tried.items()}
        quality = _next_quality(errors, slope if len(errors) == 1 else _slope(errors))
    return list(tried)[target.nearest(list(tried.values()))]


def _next_quality(errors: dict[float, float], slope: float) -> float:
    """From the rate errors of qualities that were tried, in their order, and octaves for a step of quality."""
    coarser = max((at for at in errors if errors[at] <= 0), default=None)
    finer = min((at for at in errors if errors[at] > 0), default=None)
    if coarser is None or finer is None:
        end = max(errors) if finer is None else min(errors)
        quality = end - min(max(errors[end] / slope, -_MAX_MOVE), _MAX_MOVE)
    else:  # regula falsi, where an end that stays counts half (Illinois)
        last, older = list(errors)[-1], list(errors)[-2]
        stays = (finer if last == coarser else coarser) if (errors[last] > 0) == (errors[older] > 0) else None
        below, above = (errors[at] * (0.5 if at == stays else 1.0) for at in (coarser, finer))
        quality = coarser + below / (below - above) * (finer - coarser)
    choices = [min(max(step * round(quality / step), MIN_QUALITY), MAX_QUALITY) for step in _RESOLUTIONS]
    return next((choice for choice in choices if choice not in errors), choices[-1])


def _slope(errors: dict[float, float]) -> float:
    """Octaves for a step of quality, by the two streams nearest to the target."""
    one, other = sorted(errors, key=lambda at: abs(errors[at]))[:2]
    return min(max((errors[one] - errors[other]) / (one - other), _MIN_SLOPE), _MAX_SLOPE)
