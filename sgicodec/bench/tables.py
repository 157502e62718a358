"""The summary as tables on a terminal."""

from __future__ import annotations

import math
from itertools import groupby

from rich.console import Console
from rich.table import Table

from sgicodec.bench.summary import RATES, Comparison, Summary, is_sgi

__all__ = ["print_summary"]


def print_summary(summary: Summary, console: Console) -> None:
    """Print quality at equal rates, the BD-rates and the times."""
    count = len(summary.pictures)
    _print(console, f"PSNR in dB at equal rate, mean of {count} (– where not all reach it)", _rate_table(summary))
    for title, own in groupby(summary.comparisons, _title):
        _print(console, title, _delta_table(list(own)))
    _print(console, "Times, mean of all points", _time_table(summary))


def _print(console: Console, title: str, table: Table) -> None:
    """The title on a line of its own: rich would fold it to the width of a narrow table."""
    console.print(title, style="bold", highlight=False)
    console.print(table)


def _rate_table(summary: Summary) -> Table:
    count = len(summary.pictures)
    table = Table("codec")
    for rate in RATES:
        table.add_column(f"{rate:g} bpp", justify="right")
    for name, means in summary.means.items():
        cells = (_cell(value if reached == count else math.nan, ".2f") for value, reached in means.values())
        table.add_row(name, *cells)
    return table


def _title(comparison: Comparison) -> str:
    if is_sgi(comparison.test):
        return f"BD-rate in % of {comparison.test} against"
    return f"BD-rate in % against {comparison.anchor} of"


def _delta_table(comparisons: list[Comparison]) -> Table:
    """A column for each other codec: the pictures' BD-rates by PSNR, then the means by each measure."""
    table = Table("picture")
    by_psnr = [comparison for comparison in comparisons if comparison.measure == "psnr"]
    for comparison in by_psnr:
        other = comparison.anchor if is_sgi(comparison.test) else comparison.test
        table.add_column(other, justify="right")
    for picture in dict.fromkeys(name for comparison in by_psnr for name in comparison.rates):
        deltas = (comparison.rates.get(picture) for comparison in by_psnr)
        table.add_row(picture, *(_cell(delta.value if delta else math.nan, "+.1f") for delta in deltas))
    table.add_section()
    for measure in dict.fromkeys(comparison.measure for comparison in comparisons):
        means = (_mean_cell(comparison) for comparison in comparisons if comparison.measure == measure)
        table.add_row(f"mean, {measure}", *means)
    return table


def _mean_cell(comparison: Comparison) -> str:
    known = sum(delta.reason is None for delta in comparison.rates.values())
    some = "" if known == len(comparison.rates) else f" (of {known})"
    return _cell(comparison.mean_rate, "+.1f") + some


def _time_table(summary: Summary) -> Table:
    table = Table("codec")
    for heading in ("encode s", "decode s", "memory MiB"):
        table.add_column(heading, justify="right")
    for name, own in summary.to_json()["times"].items():
        encode, decode, memory = (math.nan if value is None else value for value in own.values())
        table.add_row(name, _cell(encode, ".3f"), _cell(decode, ".3f"), _cell(memory, ".0f"))
    return table


def _cell(value: float, form: str) -> str:
    return "–" if math.isnan(value) else format(value, form)
