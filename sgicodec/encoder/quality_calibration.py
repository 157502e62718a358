"""Calibration of a quality: how far λ, and then steps of texture, move so that pictures of one quality look alike.

Equal steps look worse where a picture is fine-grained, and better where it is soft or its colours change slowly. How
many steps of quality make up for that is predicted from four means over blocks of the picture's log gradients, by a
linear fit to 69 pictures (docs/notes/2026-11-same-look.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from math import ceil

import numpy as np

from sgicodec.arrays import F32, F64
from sgicodec.bitstream.header import Masked
from sgicodec.encoder.input.nodata import empty_pixels
from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.picture import Picture, exact_samples, nodata_samples, to_unit
from sgicodec.rate_control.quality_search import QUALITY_PER_OCTAVE

_PLANES = {"luma": np.array([0.25, 0.625, 0.125], np.float32), "green": np.array([-0.5, 1.0, -0.5], np.float32)}
_FEATURES = (("luma", 0, 5.7, -5.56), ("luma", 2, -5.2, -5.09), ("green", 2, 2.2, -7.56), ("green", 4, -1.5, -7.37))
"""Plane, octave, steps of quality for a unit of the mean log gradient, and what that is in the mean of pictures."""
_MAX_OFFSET = 10.0
_LAST_QUALITY, _SPAN = 100.0, 44.0
"""The offset fades towards the highest quality, where all pictures look alike."""

_BLOCK, _WINDOW, _MAX_WINDOWS = 64, 512, 16
"""Pixels of the sides of blocks, and of the windows that are looked at."""
_FLOOR = 1e-4
"""Squared gradient, samples², that counts as none."""


def with_quality_calibration(windows: Windows, plan: Plan) -> Plan:
    """The plan at the λ with which the picture looks as others do at the quality that was asked for. Only of pictures
    that are tuned for the eye and not of bands without a meaning, and only where a quality was asked for.
    """
    settings, header = plan.settings, plan.header
    if not settings.is_quality_asked or settings.tuned_for != "visual" or header.channels == "multi":
        return plan
    gradients = [log_gradients(picture, header.masked) for picture in _sample(windows, header.width, header.height)]
    blocks = np.concatenate(gradients)
    offset = quality_offset(blocks.mean(axis=0), settings.chosen_quality) if len(blocks) else 0.0
    planned = plan.at(settings.fit_settings().lmbda * 2.0 ** (-offset / QUALITY_PER_OCTAVE))
    return planned if header.tile else replace(planned, calibrated_quality=settings.chosen_quality)


def quality_offset(gradients: F64, quality: float) -> float:
    """Steps of quality to add for the means [4] of `log_gradients` over a picture."""
    steps = sum(slope * (value - usual) for value, (*_, slope, usual) in zip(gradients, _FEATURES, strict=True))
    fade = max(0.0, (_LAST_QUALITY - quality) / _SPAN)
    return float(np.clip(fade * steps, -_MAX_OFFSET, _MAX_OFFSET))


def log_gradients(picture: Picture, masked: Masked | None) -> F64:
    """Logs of the mean squared gradients that _FEATURES name in each block of a picture [n, 4], those left out that
    have pixels without content, in them or beside them. Pictures narrower than a block have none.
    """
    samples = to_unit(picture)[..., : picture.alpha]
    if samples.shape[2] == 1:
        planes = {"luma": samples[..., 0]}
    else:
        planes = {name: samples[..., :3] @ weights for name, weights in _PLANES.items()}
    means = [
        _block_means(_squared_gradient(_reduced(planes[name], octave)), octave)
        for name, octave, *_ in _FEATURES
        if name in planes
    ]
    if masked == "transparent":
        unseen = empty_pixels(picture, masked)
    elif picture.nodata is None and not picture.exact:
        unseen = np.zeros(picture.pixels.shape[:2], np.bool_)
    else:
        unseen = np.asarray((nodata_samples(picture) | exact_samples(picture)).any(axis=-1))
    empty = _block_means(unseen.astype(np.float32), 0) > 0
    beside = empty.copy()  # gradients reach into the next block
    beside[:, :-1] |= empty[:, 1:]
    beside[:-1] |= empty[1:]
    logs: F64 = np.log(np.stack(means, axis=-1) + _FLOOR)[~beside]
    absent = [usual for name, *_, usual in _FEATURES if name not in planes]  # of grey pictures, colours
    return np.concatenate([logs, np.tile(absent, (len(logs), 1))], axis=1)


def _reduced(plane: F32, octaves: int) -> F32:
    for _ in range(octaves):
        plane = plane[: len(plane) // 2 * 2, : plane.shape[1] // 2 * 2]
        plane = np.float32(0.25) * (plane[::2, ::2] + plane[1::2, ::2] + plane[::2, 1::2] + plane[1::2, 1::2])
    return plane


def _squared_gradient(plane: F32) -> F32:
    """Of the differences to the next pixel in both directions, none behind the last one."""
    squares = np.zeros_like(plane)
    squares[:, :-1] += np.diff(plane, axis=1) ** 2
    squares[:-1] += np.diff(plane, axis=0) ** 2
    return squares


def _block_means(plane: F32, octave: int) -> F64:
    """Means of the blocks that lie wholly in a plane reduced by so many octaves [rows, columns]."""
    side = _BLOCK >> octave
    rows, columns = len(plane) // side, plane.shape[1] // side
    blocks = plane[: rows * side, : columns * side].reshape(rows, side, columns, side)
    means: F64 = blocks.mean(axis=(1, 3), dtype=np.float64)
    return means


def _sample(windows: Windows, width: int, height: int) -> Iterator[Picture]:
    """The picture in windows; of a large one _MAX_WINDOWS at most, evenly spread, from the top down."""
    columns, rows = ceil(width / _WINDOW), ceil(height / _WINDOW)
    while columns * rows > _MAX_WINDOWS:
        columns, rows = ceil(columns / 2), ceil(rows / 2)
    for (y, high), (x, wide) in product(_spans(height, rows), _spans(width, columns)):
        yield windows.read(x, y, wide, high)


def _spans(side: int, count: int) -> list[tuple[int, int]]:
    """Where each of `count` windows along a side begins, and its length: they are in the middles of equal shares."""
    size = min(_WINDOW, side // count)
    return [((2 * number + 1) * side // (2 * count) - size // 2, size) for number in range(count)]


_QUALITIES = (1.0, 10.0, 20.0, 30.0, 44.0, 57.0, 70.0, 83.0, 90.0, 97.0, 100.0)
_SCORES = (-45.0, -21.0, 3.0, 25.5, 51.5, 68.7, 80.3, 87.9, 90.5, 92.7, 93.6)
"""SSIMULACRA 2 that a quality has in the mean of pictures (docs/notes/2026-11-same-look.md)."""
_PER_QUALITY, _MAX_MOVE = 2.5, 32
"""Indices of texture's steps for a step of quality, which would be 2 if seeds followed, and the most that they move
(docs/notes/2026-11-same-look.md, 2026-11-equal-losses.md)."""
_NEARLY, _GAIN = 1.5, 1.1
"""Steps of quality that a score may be off, and that a pass gains; several gain with the root of their number
(docs/notes/2026-11-same-look.md)."""


@dataclass
class CalibratedSteps:
    """The index of texture's steps on the way to the look of a quality, `quality` None for none, in the course of so
    many passes of gradient ascent.

    What a pass gains belongs to its steps. So they stay in the last pass, if there are two; and a score that
    is nearly right is left alone.
    """

    quality: float | None
    step: int
    passes: int
    _begin: int = field(init=False)
    _scores: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._begin = self.step

    def after(self, score: float | None) -> int:
        """The index for the next layer, if the last one had this SSIMULACRA 2 score; None where there was none."""
        if self.quality is None or score is None or self._scores == max(1, self.passes - 1):
            return self.step
        to_come = _GAIN * (self.passes - self._scores) ** 0.5
        self._scores += 1
        off = float(np.interp(score, _SCORES, _QUALITIES)) + to_come - self.quality
        too_far = off - float(np.clip(off, -_NEARLY, _NEARLY))
        moved = self.step - self._begin + round(_PER_QUALITY * too_far)
        self.step = self._begin + min(max(moved, -_MAX_MOVE), _MAX_MOVE)
        return self.step
