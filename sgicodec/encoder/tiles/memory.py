"""As many workers as there is memory for (docs/large.md, "Memory")."""

from __future__ import annotations

import math

import numpy as np

from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.executors.executor import MIB, Executor, Memory
from sgicodec.profiles.default import DEFAULT_LMBDA

_MAIN = 150 * MIB
"""The process that reads and writes: Python, numpy, OpenImageIO. One that fits too has room for them in _WORKER."""
_WORKER = 110 * MIB
"""A process that fits: Python, numpy, and what a fit takes of any size."""
_PIXEL_BYTES, _CHANNEL_BYTES = 52, 16
"""Of images in a fit for each pixel, and for each of its channels."""
_SEED_BYTES = 1400
"""Of a fit for each seed that it starts with."""
_UNIFORM_SAMPLE_BYTES, _UNIFORM_ATTRIBUTE_BYTES = 6, 100
"""In a uniform layout: for each sample, and for each attribute of each seed, 7.4 kB for the 74 of K = 10, D = 50.
Measured with 1,000 and 40,000 seeds in 0.4 megapixels 110 and 381 MiB, with 350,000 in 52.3 megapixels 3,318."""
_SCORED_PIXEL_BYTES, _SCORED_CHANNEL_BYTES = 140, 50
"""For each pixel, and for each of its channels, while a score says what texture should show."""
_MAX_SEEDS, _USUAL_SEEDS = 0.25, 0.1
"""Seeds for each pixel: cells have four pixels at least; dense texture starts with a tenth at the default quality."""


def within_memory(windows: Windows, plan: Plan, executor: Executor | None) -> tuple[Executor, Memory]:
    """The executor, by default this process, with no more workers than there is memory for, and what that takes at its
    peak. Raises UsageError where one is too many.
    """
    grid = plan.header.grid
    memory = _estimate(plan, windows.memory(*grid.rect(0)[2:]))
    return (executor or Executor()).within(memory, grid.count), memory


def _estimate(plan: Plan, reading: int) -> Memory:
    """For dense detail; `reading` is what the source holds while its windows are read."""
    header, fit = plan.header, plan.settings.fit_settings()
    _, _, width, height = header.grid.rect(0)
    pixels, channels = (width + 2 * header.apron) * (height + 2 * header.apron), header.spec.channels
    window = pixels * channels * np.dtype(header.sample_type).itemsize
    if header.spec.layout == "uniform":
        attributes = (fit.seeds or pixels / 400) * header.spec.attributes
        fitting = pixels * channels * _UNIFORM_SAMPLE_BYTES + attributes * _UNIFORM_ATTRIBUTE_BYTES
        return Memory(_MAIN + reading + 2 * window, _WORKER + window + round(fitting), _MAIN)
    share = _MAX_SEEDS  # where the quality follows from a target
    if plan.settings.target is None:
        share = min(_MAX_SEEDS, _USUAL_SEEDS * math.sqrt(DEFAULT_LMBDA / max(fit.lmbda, 1e-9)))
    fitting = pixels * (_PIXEL_BYTES + _CHANNEL_BYTES * channels + _SEED_BYTES * share)
    if header.spec.texture and plan.settings.chosen_effort.ascent_passes:
        fitting = max(fitting, pixels * (_SCORED_PIXEL_BYTES + _SCORED_CHANNEL_BYTES * channels))
    return Memory(_MAIN + reading + 2 * window, _WORKER + window + round(fitting), _MAIN)
