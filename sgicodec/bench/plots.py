"""The summary as pictures: rate–distortion of each picture and of their mean, time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.bench.measures import MEASURES
from sgicodec.bench.rows import Row
from sgicodec.bench.summary import Summary, curves, is_sgi, mean_at, picture_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def write_plots(summary: Summary, out_dir: Path) -> list[Path]:
    """Write the plots as PNG files and return their paths."""
    paths = []
    for name, figure in _figures(summary):
        paths.append(out_dir / f"{name}.png")
        figure.savefig(paths[-1], dpi=120)
    return paths


def _figures(summary: Summary) -> Iterator[tuple[str, Figure]]:
    yield "rd-mean", _mean_figure(summary)
    yield "time", _time_figure(summary)
    for label in summary.pictures:
        name, crc = label.rsplit(" ", 1)
        yield f"rd-{Path(name).stem}-{crc}", _picture_figure(summary, label)


def _figure(width: float, height: float = 5) -> Figure:
    """A figure outside of pyplot: no window system, nothing to close."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _style(summary: Summary, codec: str) -> dict[str, Any]:
    """The same colour for a codec in every plot; sgi stands out."""
    return {
        "color": f"C{summary.codecs.index(codec)}",
        "linewidth": 2.4 if is_sgi(codec) else 1.3,
        "marker": "o",
        "markersize": 3,
        "label": codec,
    }


_DRAWN = ("psnr", "ms_ssim", "ssimulacra2", "butteraugli", "flip", "cvvdp", "lpips", "dists")
"""Measures that have a panel for each picture."""


def _picture_figure(summary: Summary, label: str) -> Figure:
    measures = [name for name in _DRAWN if _is_known(summary, name)]
    lines = -(-len(measures) // 2)
    figure = _figure(13, 5 * lines)
    panels = dict(zip(measures, figure.subplots(lines, 2).flat, strict=False))
    for unused in figure.axes[len(measures) :]:
        unused.remove()
    for codec in summary.codecs:
        own = [row for row in summary.rows if row.codec == codec and picture_label(row) == label]
        own.sort(key=lambda row: row.bpp)
        rates = [row.bpp for row in own]
        for name, axes in panels.items():
            values = [MEASURES[name].quality(row) for row in own]
            if not all(map(math.isnan, values)):
                axes.plot(rates, values, **_style(summary, codec))
    for name, axes in panels.items():
        _label(axes, label, MEASURES[name].axis)
    return figure


def _mean_figure(summary: Summary) -> Figure:
    """Means at equal rates, over the range that every picture's curve covers."""
    figure = _figure(7 * len(summary.means))
    panels = dict(zip(summary.means, figure.subplots(1, len(summary.means), squeeze=False)[0], strict=True))
    rates = np.geomspace(0.02, 8, 241)
    for name, axes in panels.items():
        for codec in summary.means[name]:
            own = curves(summary.rows, codec, name)
            means = [mean_at(own, float(rate)) for rate in rates]
            values = [value if count == len(summary.pictures) else math.nan for value, count in means]
            axes.plot(rates, values, **_style(summary, codec) | {"marker": ""})
        _label(axes, f"mean of {len(summary.pictures)} pictures at equal rate", MEASURES[name].axis)
    return figure


def _is_known(summary: Summary, measure: str) -> bool:
    """Whether any point has the measure; PSNR counts as known."""
    quality = MEASURES[measure].quality
    return measure == "psnr" or not all(math.isnan(quality(row)) for row in summary.rows)


def _time_figure(summary: Summary) -> Figure:
    """Encode and decode seconds per megapixel of each rung of the ladders, mean over the pictures."""
    figure = _figure(13)
    panels = dict(zip(("encode_seconds", "decode_seconds"), figure.subplots(1, 2), strict=True))
    for codec in summary.codecs:
        rungs: dict[str, list[Row]] = {}
        for row in summary.rows:
            if row.codec == codec:
                rungs.setdefault(row.settings, []).append(row)
        for field, axes in panels.items():
            points = sorted((_mean(own, "bpp"), _mean_per_megapixel(own, field)) for own in rungs.values())
            if not all(math.isnan(seconds) for _, seconds in points):
                axes.plot([x for x, _ in points], [y for _, y in points], **_style(summary, codec))
    for field, axes in panels.items():
        axes.set_yscale("log")
        _label(axes, field.split("_")[0], "seconds per megapixel")
    return figure


def _mean(rows: Sequence[Row], field: str) -> float:
    return float(np.mean([getattr(row, field) for row in rows]))


def _mean_per_megapixel(rows: Sequence[Row], field: str) -> float:
    return float(np.mean([getattr(row, field) / (row.width * row.height / 1e6) for row in rows]))


def _label(axes: Axes, title: str, quantity: str) -> None:
    axes.set(title=title, xlabel="bits per pixel", ylabel=quantity)
    axes.grid(alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
