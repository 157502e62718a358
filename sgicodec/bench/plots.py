"""The summary as pictures: rate–distortion of each picture and of their mean, bytes at equal quality, time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec.bench.measures import MEASURES
from sgicodec.bench.rows import Row
from sgicodec.bench.savings import Savings, savings
from sgicodec.bench.summary import Comparison, Summary, curves, is_sgi, mean_at, picture_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["write_plots"]


def write_plots(summary: Summary, out_dir: Path) -> list[Path]:
    """Write the plots as PNG files and return their paths."""
    paths = []
    for name, figure in _figures(summary):
        paths.append(out_dir / f"{name}.png")
        figure.savefig(paths[-1], dpi=120)
    return paths


def _figures(summary: Summary) -> Iterator[tuple[str, Figure]]:
    yield "rd-mean", _mean_figure(summary)
    figure = _savings_figure(summary)
    if figure is not None:
        yield "savings", figure
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


def _savings_figure(summary: Summary) -> Figure | None:
    """Bytes of sgi against each other codec, or of all against the first, with confidence intervals over pictures; None
    where no two curves of all pictures share a quality.
    """
    of_sgi = any(is_sgi(comparison.test) for comparison in summary.comparisons)
    wanted = [each for each in summary.comparisons if each.measure in summary.means and is_sgi(each.test) == of_sgi]
    found = [(each, saved) for each in wanted if (saved := _savings(summary, each)) is not None]
    measures = list(dict.fromkeys(each.measure for each, _ in found))
    if not measures:
        return None
    figure = _figure(7 * len(measures))
    panels = dict(zip(measures, figure.subplots(1, len(measures), squeeze=False)[0], strict=True))
    tests = list(dict.fromkeys(each.test for each, _ in found))
    for each, saved in found:
        style = _style(summary, each.anchor if of_sgi else each.test) | {"marker": "", "linewidth": 1.8}
        dashes = ("-", "--", ":", "-.")[tests.index(each.test) % 4 if of_sgi else 0]
        style |= {"label": f"{each.test} against {each.anchor}", "linestyle": dashes}
        panels[each.measure].plot(saved.qualities, saved.percent, **style)
        panels[each.measure].fill_between(saved.qualities, saved.low, saved.high, color=style["color"], alpha=0.15)
    for name, axes in panels.items():
        axes.axhline(0, color="black", linewidth=0.8)
        _label(axes, f"mean of {len(summary.pictures)} pictures at equal quality", "bytes, %", MEASURES[name].axis)
    return figure


def _savings(summary: Summary, comparison: Comparison) -> Savings | None:
    tests, anchors = (curves(summary.rows, name, comparison.measure) for name in (comparison.test, comparison.anchor))
    return savings(anchors, tests, MEASURES[comparison.measure].within)


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


def _label(axes: Axes, title: str, quantity: str, over: str = "bits per pixel") -> None:
    axes.set(title=title, xlabel=over, ylabel=quantity)
    axes.grid(alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
