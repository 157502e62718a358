"""How far a stream is from its source, band by band."""

from __future__ import annotations

import math

import numpy as np

from sgicodec.decoder import Stream
from sgicodec.image import Picture, Source, to_unit

__all__ = ["measured_psnr", "squared_error"]


def measured_psnr(stream: Stream, source: Source, threads: int = 0) -> float:
    """PSNR in dB over all samples of what the stream decodes to, but for colours where alpha is 0."""
    total, samples = 0.0, 0
    for top, band in stream.bands(threads=threads):
        original = source.read(0, top, band.width, band.height)
        total += squared_error(original, band)
        samples += band.pixels.size
    return 10 * math.log10(samples / total) if total else math.inf


def squared_error(original: Picture, decoded: Picture) -> float:
    """Summed over samples in 0..1; colours that nobody sees count nothing."""
    error = 0.0
    for row in range(0, original.height, _ROWS):
        rows = slice(row, row + _ROWS)
        parts = (Picture(p.pixels[rows], p.channels, original.sample_range, p.metadata) for p in (original, decoded))
        ours, theirs = (to_unit(part) for part in parts)
        difference = ours.astype(np.float64) - theirs
        if original.alpha is not None:
            difference[ours[..., original.alpha] == 0, : original.alpha] = 0
        error += float((difference**2).sum())
    return error


_ROWS = 64
