"""Gradient ascent of a texture layer on two scores: what the layer should show moves, then it is searched anew.

The search weighs squared errors by frequency and place alone. The gradient of a score at what is decoded says which of
the errors that are left are seen. SSIMULACRA 2 looks at structure; Butteraugli looks at differences, the largest most
of all, and holds back what the other would overdo in places. A target that has moved up the gradient makes the same
search trade errors better: squared error to it is a quadratic model of the scores, renewed in each pass. The model
holds near by only, so that amplitudes move by a small part of their steps at a time. Between superblocks, steps are
traded by the same gradient: they are best where a bit more gains as much everywhere. To first order, the errors of a
superblock take from a score what its gradient says of them. That falls with the square of the step, while each symbol
that is not 0 takes about a bit more for half the step. So all superblocks should lose as much of the score for each of
their symbols.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.device import Device
from sgicodec.encoder.tile.restoration import Strength, rendered_over
from sgicodec.encoder.tile.sharing import smoothed
from sgicodec.metrics.butteraugli import ButteraugliReference
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.luma_space import from_luma_space
from sgicodec.model.texture_symbols import CONTRAST_LIMIT, TextureSymbols, root_blocks
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["Ascended", "Offsets", "ScoreAscent", "better_offsets"]

F32 = NDArray[np.float32]
Offsets = NDArray[np.int8] | None

LayerSearch = Callable[[TextureSymbols | None, float | None, Offsets], TextureSymbols | None]

BUTTERAUGLI = 60.0
"""Points of SSIMULACRA 2 for which the logarithm of Butteraugli's 3-norm falls by one. 80 takes more bytes at equal
scores, by both (docs/notes/2026-11-score-ascent.md).
"""
MEAN_MOVE = 0.0125
"""Of amplitudes in all passes, in steps, times the root of their number. 0.009 and 0.017 take up to 0.8 % more bytes
(docs/notes/2026-11-equal-losses.md)."""
MAX_MOVE = 12.0
"""Of one amplitude, in means (docs/notes/2026-11-score-ascent.md)."""
FINER_STEPS = 40.0
"""Points that steps so fine as to take e times the bits would gain (docs/notes/2026-11-score-ascent.md)."""
SHORTER = 0.5
"""What moves are to the ones before, where those gained less than finer steps would for their bits."""


@dataclass(frozen=True)
class _Seen:
    """What both scores say of a picture. score: SSIMULACRA 2; points: of both; gradient [C, H, W]: of these."""

    score: float
    points: float
    gradient: F32


class _Scores:
    """Both scores of pictures [C, H, W] next to one original, as samples in 0..1."""

    def __init__(self, original: F32, device: Device) -> None:
        self._structure, self._differences = VisualReference(original, device), ButteraugliReference(original, device)

    def of(self, decoded: F32) -> _Seen:
        """Of one picture."""
        score, gradient = self._structure.gradient(decoded)
        distance, _, farther = self._differences.gradient(decoded)
        if distance == 0:  # it has a side of a few pixels
            return _Seen(score, score, gradient)
        return _Seen(
            score,
            score - BUTTERAUGLI * math.log(distance),
            gradient - np.float32(BUTTERAUGLI / distance) * farther,
        )


@dataclass
class _Pace:
    """How far amplitudes move in a pass: less once moves gain no more than their bits. mean: in steps."""

    mean: float
    _last: tuple[int, float] | None = None

    def after(self, step: int, bits: float, points: float) -> float:
        """The mean of the moves that follow a layer of this step."""
        gained = points - FINER_STEPS * math.log(max(bits, 1.0))
        if self._last is not None and self._last[0] == step and gained < self._last[1]:
            self.mean *= SHORTER
        self._last = step, gained
        return self.mean


class Ascended(NamedTuple):
    """What an ascent ends with. symbols: the last layer that was found; score: its SSIMULACRA 2 if it has one;
    offsets: step offsets with which the next is to be searched.
    """

    symbols: TextureSymbols | None
    score: float | None
    offsets: Offsets


@dataclass(frozen=True)
class ScoreAscent:
    """The ascent for layers of one picture. unit [C, H, W]: what they are to show, in luma space where `luma_space`;
    empty [H, W]: pixels that count nothing, None for none; strength: with which what is rendered is restored, None for
    not at all.
    """

    unit: F32
    luma_space: bool
    empty: NDArray[np.bool_] | None
    device: Device
    strength: Strength | None = None

    def run(
        self,
        search: TextureSearch,
        best_layer: LayerSearch,
        usual: Offsets,
        passes: int,
        ending: Callable[[], bool] = lambda: False,
    ) -> Ascended:
        """Moves the target of `search` in this many passes, or until `ending`. `best_layer` gives its best layer of the
        blocks of the layer before or, with None, of any, with these step offsets; it is told SSIMULACRA 2 of the layer
        before, too. usual [rows, columns]: step offsets of the first layer, None where superblocks have none.
        """
        scores, pace = _Scores(self._seen(self.unit), self.device), _Pace(MEAN_MOVE / passes**0.5)
        symbols, score, offsets = None, None, usual
        for _ in range(passes):
            if ending() or (symbols := best_layer(symbols, score, offsets)) is None:
                break
            rendered = self._rendered(search, symbols)
            seen = scores.of(self._seen(rendered))
            score, gradient = seen.score, self._in_unit(seen.gradient)
            if self.empty is not None:
                gradient[:, self.empty] = 0
            mean = pace.after(symbols.steps.step, search.bits, seen.points)
            search.move(gradient, symbols.steps, offsets, mean, MAX_MOVE * mean)
            if offsets is not None and usual is not None:
                gain = (gradient * (self.unit - rendered)).sum(axis=0)
                offsets = better_offsets(offsets, usual, gain, symbols)
        return Ascended(symbols, score, offsets)

    def _rendered(self, search: TextureSearch, symbols: TextureSymbols) -> F32:
        """What a layer shows over the seeds of `search`, restored."""
        rendered = rendered_over(search, self.unit, symbols, self.device)
        if self.strength is not None:
            rendered += self.strength.over(symbols).correction(rendered, self.device)
        if self.empty is not None:
            rendered[:, self.empty] = self.unit[:, self.empty]
        return rendered

    def _seen(self, planes: F32) -> F32:
        """Samples as they are seen."""
        if not self.luma_space:
            return planes
        return np.tensordot(from_luma_space(len(planes)).astype(np.float32), planes, axes=1)

    def _in_unit(self, gradient: F32) -> F32:
        """A gradient in samples as they are seen, in those of `unit`."""
        if not self.luma_space:
            return gradient
        return np.tensordot(from_luma_space(len(gradient)).T.astype(np.float32), gradient, axes=1)


_PART = 0.25
"""Of the way to equal losses that step offsets go at a time: a gradient is noisy, and holds near by only. This, σ and
the fewest symbols were tried together (docs/notes/2026-11-equal-losses.md)."""
_MAX_AWAY = 4
"""Quarters of an octave that they may be away from those of the tuning."""
_SIGMA = 0.5
"""Over which losses and symbols are smoothed, in superblocks: neighbours that differ cost bits."""
_MIN_SYMBOLS = 128
"""Of a superblock that tells something. Where seeds do most of the work, offsets stay."""
_PSEUDO_COUNT = 40
"""Pseudo-count: side-information bits of a superblock, in symbols."""
_MIN_LOSS = 0.2
"""Of a superblock, in means."""


def better_offsets(
    offsets: NDArray[np.int8], usual: NDArray[np.int8], gain: F32, symbols: TextureSymbols
) -> NDArray[np.int8]:
    """The step offsets [rows, columns] of the next layer. offsets: of this one; usual: of the tuning; gain [H, W]: what
    the score would grow by, to first order, without the error of each pixel.

    Their mean over symbols stays, so that a layer takes about as many bits.
    """
    lost = root_blocks(gain.astype(np.float64), "constant").sum(axis=(1, 3))
    counts = lost != 0  # where no pixel counts, offsets do not
    lost = smoothed(lost, _SIGMA)
    coded = root_blocks((symbols.symbols != 0).sum(axis=0), "constant").sum(axis=(1, 3), dtype=np.float64)
    count = smoothed(coded, _SIGMA)
    tells = counts & (count >= _MIN_SYMBOLS)
    least = _MIN_LOSS * float(lost.mean())
    if least <= 0 or not tells.any():
        return offsets
    weight = np.where(tells, count + _PSEUDO_COUNT, 0.0)
    octaves = 0.5 * np.log2(np.maximum(lost, least) / (count + _PSEUDO_COUNT))
    octaves = np.where(tells, octaves - np.average(octaves, weights=weight), 0.0)
    wanted = np.clip(offsets - 4 * _PART * octaves, usual - float(_MAX_AWAY), usual + float(_MAX_AWAY))
    return np.clip(np.rint(wanted), -CONTRAST_LIMIT, CONTRAST_LIMIT).astype(np.int8)
