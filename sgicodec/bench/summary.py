"""What follows from a run's rows: quality at equal rates, BD-rates, times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sgicodec.bench.bdrate import Curve, Delta, bd_quality, bd_rate
from sgicodec.bench.confidence import interval
from sgicodec.bench.measures import MEASURES
from sgicodec.bench.rows import Row

RATES = (0.15, 0.2, 0.3, 0.5, 0.75, 1.0)  # bits per pixel

AT_RATES = ("psnr", "ssimulacra2", "butteraugli", "flip", "cvvdp", "lpips", "dists")
"""Measures whose means at these rates are told."""


@dataclass(frozen=True)
class Comparison:
    """The BD-rate in percent (and the delta in quality) of codec `test` against `anchor`, by one measure."""

    test: str
    anchor: str
    measure: str
    rates: dict[str, Delta]  # by picture
    qualities: dict[str, Delta]  # by picture

    @property
    def mean_rate(self) -> float:
        """Mean of the pictures' BD-rates in percent, over those that have one."""
        return _mean([delta.value for delta in self.rates.values()])

    @cached_property
    def interval(self) -> tuple[float, float]:
        """The ends of the confidence interval of `mean_rate` over pictures; not-a-number for too few."""
        known = [delta.value for delta in self.rates.values() if not math.isnan(delta.value)]
        low, high = interval(np.array(known))
        return float(low), float(high)

    @property
    def mean_quality(self) -> float:
        """Mean of the pictures' deltas in quality, over those that have one."""
        return _mean([delta.value for delta in self.qualities.values()])


@dataclass(frozen=True)
class Summary:
    """A run's rows and what was made of them.

    `means[measure][codec][bpp]` holds the mean quality and the number of pictures whose curve reaches that rate.
    """

    rows: list[Row]
    codecs: list[str]
    pictures: list[str]
    means: dict[str, dict[str, dict[float, tuple[float, int]]]]
    comparisons: list[Comparison]
    failures: list[str]

    def bytes_at(self, score: float) -> dict[str, dict[str, float]]:
        """Bytes at which each codec's curve reaches a SSIMULACRA 2, by picture; NaN where it does not."""
        sizes = {picture_label(row): row.width * row.height for row in self.rows}
        by_codec = {name: curves(self.rows, name, "ssimulacra2") for name in self.codecs}
        return {
            picture: {name: own[picture].rate_at(score) * size / 8 for name, own in by_codec.items() if picture in own}
            for picture, size in sizes.items()
        }

    def to_json(self, score: float | None = None) -> dict[str, Any]:
        """A tree of plain values, with bytes at a score where one is given; what is not a number is null."""
        at_score = {} if score is None else self.bytes_at(score)
        return {
            "pictures": self.pictures,
            "codecs": {name: sorted({row.version for row in self.rows if row.codec == name}) for name in self.codecs},
            **{f"mean_{measure}_at_bpp": _means_json(measure, means) for measure, means in self.means.items()},
            "times": {name: times(self.rows, name) for name in self.codecs},
            "comparisons": [_comparison_json(comparison) for comparison in self.comparisons],
            "bytes_at_score": {of: {k: _plain(v) for k, v in own.items()} for of, own in at_score.items()},
            "failures": self.failures,
        }


def picture_label(row: Row) -> str:
    """Names a picture in tables; the CRC distinguishes two of one file name."""
    return f"{row.picture} {row.crc}"


def curves(rows: Sequence[Row], codec: str, measure: str = "psnr") -> dict[str, Curve]:
    """The rate–quality curve of a codec on each picture, rate in bpp."""
    by_picture: dict[str, list[Row]] = {}
    for row in rows:
        if row.codec == codec:
            by_picture.setdefault(picture_label(row), []).append(row)
    quality = MEASURES[measure].quality
    return {name: Curve([r.bpp for r in own], [quality(r) for r in own]) for name, own in by_picture.items()}


def mean_at(own: dict[str, Curve], bpp: float) -> tuple[float, int]:
    """Mean quality at a rate over the pictures whose curve reaches it, and how many these are."""
    values = [value for curve in own.values() if not math.isnan(value := curve.quality_at(bpp))]
    return _mean(values), len(values)


def times(rows: Sequence[Row], codec: str) -> dict[str, float | None]:
    """Mean seconds to encode and decode over all points, and the largest memory in MiB where known."""
    own = [row for row in rows if row.codec == codec]
    memory = [row.memory_mib for row in own if row.memory_mib is not None]
    return {
        "encode_seconds": _plain(_mean([row.encode_seconds for row in own])),
        "decode_seconds": _plain(_mean([row.decode_seconds for row in own])),
        "memory_mib": max(memory, default=None),
    }


def summarise(rows: Sequence[Row], codecs: Sequence[str], failures: Sequence[str] = ()) -> Summary:
    """Means at `RATES`; BD-rates of each sgi curve against each peer, and of each peer against the first."""
    peers = [name for name in codecs if not is_sgi(name)]
    pairs = [(test, anchor) for test in codecs if is_sgi(test) for anchor in peers]
    pairs += [(test, peers[0]) for test in peers[1:]]
    taken = {name: _taken(rows, name) for name in codecs}
    means = {
        measure: {name: {rate: mean_at(curves(rows, name, measure), rate) for rate in RATES} for name in known}
        for measure in AT_RATES
        if (known := [name for name in codecs if measure in taken[name]])
    }
    comparisons = [
        _compare(rows, test, anchor, measure)
        for test, anchor in pairs
        for measure in MEASURES
        if measure in taken[test] and measure in taken[anchor]
    ]
    pictures = list(dict.fromkeys(picture_label(row) for row in rows))
    return Summary(list(rows), list(codecs), pictures, means, comparisons, list(failures))


def _taken(rows: Sequence[Row], codec: str) -> set[str]:
    """The measures that some row of a codec holds. PSNR counts always, so that a codec that failed shows its gap."""
    own = [row for row in rows if row.codec == codec]
    return {"psnr"} | {n for n, measure in MEASURES.items() if not all(math.isnan(measure.quality(r)) for r in own)}


def _compare(rows: Sequence[Row], test: str, anchor: str, measure: str) -> Comparison:
    tests, anchors = curves(rows, test, measure), curves(rows, anchor, measure)
    common = [name for name in anchors if name in tests]
    return Comparison(
        test,
        anchor,
        measure,
        {name: bd_rate(anchors[name], tests[name], MEASURES[measure].within) for name in common},
        {name: bd_quality(anchors[name], tests[name]) for name in common},
    )


def is_sgi(name: str) -> bool:
    """Whether a codec of this name is sgi, at whatever effort."""
    return name == "sgi" or name.startswith("sgi-")


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if not math.isnan(value)]
    return sum(known) / len(known) if known else math.nan


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _means_json(measure: str, means: dict[str, dict[float, tuple[float, int]]]) -> dict[str, Any]:
    shown = MEASURES[measure].shown
    return {
        name: {f"{rate:g}": {measure: _plain(shown(value)), "pictures": count} for rate, (value, count) in at.items()}
        for name, at in means.items()
    }


def _comparison_json(comparison: Comparison) -> dict[str, Any]:
    pictures = {
        name: {
            "bd_rate_percent": _plain(rate.value),
            "bd_quality": _plain(comparison.qualities[name].value),
            "quality_range": [_plain(rate.low), _plain(rate.high)],
            "reason": rate.reason,
        }
        for name, rate in comparison.rates.items()
    }
    return {
        "test": comparison.test,
        "anchor": comparison.anchor,
        "measure": comparison.measure,
        "mean_bd_rate_percent": _plain(comparison.mean_rate),
        "bd_rate_interval_percent": [_plain(end) for end in comparison.interval],
        "mean_bd_quality": _plain(comparison.mean_quality),
        "pictures": pictures,
    }
