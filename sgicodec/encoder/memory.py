"""The memory that an encode takes at its peak (docs/large.md, "Memory")."""

from __future__ import annotations

import math

from sgicodec.encoder.plan import Plan
from sgicodec.executors.executor import MIB, Memory

__all__ = ["estimate"]

MAIN = 150 * MIB
"""The process that reads and writes: Python, numpy, OpenImageIO. One that fits too has room for them in WORKER."""
WORKER = 110 * MIB
"""A process that fits: Python, numpy, and what a fit takes of any size."""
PIXEL_BYTES, CHANNEL_BYTES = 52, 16
"""Of images in a fit for each pixel, and for each of its channels."""
SEED_BYTES = 1400
"""Of a fit for each seed that it starts with."""
UNIFORM_SAMPLE_BYTES, UNIFORM_ATTRIBUTE_BYTES = 6, 100
"""In a uniform layout: for each sample, and for each attribute of each seed, 7.4 kB for the 74 of K = 10, D = 50.
Measured with 1,000 and 40,000 seeds in 0.4 megapixels 110 and 381 MiB, with 350,000 in 52.3 megapixels 3,318."""
SCORED_PIXEL_BYTES, SCORED_CHANNEL_BYTES = 320, 50
"""For each pixel, and for each of its channels, while scores say what texture should show; 180 are Butteraugli's."""
MAX_SEEDS, USUAL_SEEDS, USUAL_LMBDA = 0.25, 0.1, 0.5 * 2 ** (-49 / 8)
"""Seeds for each pixel: cells have four pixels at least; dense texture starts with a tenth at quality 50."""


def estimate(plan: Plan, reading: int) -> Memory:
    """For dense detail; `reading` is what the source holds while its windows are read."""
    header, fit = plan.header, plan.settings.fit_settings()
    _, _, width, height = header.grid.rect(0)
    pixels, channels = (width + 2 * header.apron) * (height + 2 * header.apron), header.spec.channels
    window = pixels * channels * {"uint8": 1, "uint16": 2, "float32": 4}[header.sample_type]
    if header.spec.layout == "uniform":
        attributes = (fit.seeds or pixels / 400) * header.spec.attributes
        fitting = pixels * channels * UNIFORM_SAMPLE_BYTES + attributes * UNIFORM_ATTRIBUTE_BYTES
        return Memory(MAIN + reading + 2 * window, WORKER + window + round(fitting), MAIN)
    share = MAX_SEEDS  # where λ follows from a target
    if plan.settings.target is None:
        share = min(MAX_SEEDS, USUAL_SEEDS * math.sqrt(USUAL_LMBDA / max(fit.lmbda, 1e-9)))
    fitting = pixels * (PIXEL_BYTES + CHANNEL_BYTES * channels + SEED_BYTES * share)
    if header.spec.texture and plan.settings.chosen_effort.ascent_passes:
        fitting = max(fitting, pixels * (SCORED_PIXEL_BYTES + SCORED_CHANNEL_BYTES * channels))
    return Memory(MAIN + reading + 2 * window, WORKER + window + round(fitting), MAIN)
