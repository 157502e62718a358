"""The summary as tables on a terminal."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from itertools import groupby, product

from rich.console import Console
from rich.table import Table

from sgicodec.bench.lossless import LosslessRow
from sgicodec.bench.measures import MEASURES
from sgicodec.bench.summary import AT_RATES, RATES, Comparison, Summary, is_sgi


def print_summary(summary: Summary, console: Console) -> None:
    """Print quality at equal rates, the BD-rates and the times."""
    count = len(summary.pictures)
    for measure, means in summary.means.items():
        title = f"{MEASURES[measure].title} at equal rate, mean of {count} (– where not all reach it)"
        _print(console, title, _rate_table(measure, means, count))
    for title, own in groupby(summary.comparisons, _title):
        _print(console, title, _delta_table(list(own)))
    _print(console, "Times, mean of all points", _time_table(summary))


def print_bytes_at(summary: Summary, score: float, console: Console) -> None:
    """Print bytes at which codecs reach a SSIMULACRA 2; below, the first codec's against each other's, in the geometric
    mean of pictures on which both do.
    """
    found, first = summary.bytes_at(score), summary.codecs[0]
    table = Table("picture")
    logs: dict[str, list[float]] = {}
    for name in summary.codecs:
        table.add_column(name, justify="right")
        pairs = [own[first] / own[name] for own in found.values() if first in own and name in own]
        logs[name] = [math.log(pair) for pair in pairs if name != first and not math.isnan(pair)]
    for picture, own in found.items():
        table.add_row(picture, *(_cell(own.get(name, math.nan), ",.0f") for name in summary.codecs))
    table.add_section()
    means = (100 * math.expm1(sum(own) / len(own)) if own else math.nan for own in logs.values())
    table.add_row(f"{first} against it, %", *(_cell(mean, "+.1f") for mean in means))
    _print(console, f"Bytes at SSIMULACRA 2 of {score:g} (– where a curve does not reach it)", table)


def print_lossless(rows: Sequence[LosslessRow], console: Console) -> None:
    """Print bytes by picture and greatest error; then the first codec's bytes against each other codec's, mean of
    logarithms, and medians of processor seconds.
    """
    names = list(dict.fromkeys(row.codec for row in rows))
    sizes = Table("picture", "±")
    for name in names:
        sizes.add_column(name, justify="right")
    for (picture, crc, error), case in groupby(rows, lambda row: (row.picture, row.crc, row.max_error)):
        found = {row.codec: f"{row.bytes:,}" for row in case}
        sizes.add_row(f"{picture} {crc}", f"{error:g}", *(found.get(name, "–") for name in names))
    _print(console, "Bytes with all samples within ± (– where a codec does not take them)", sizes)
    means = Table("codec", "±")
    for heading in ("pictures", f"{names[0]}, bytes in %", "encode s/MP", "decode s/MP"):
        means.add_column(heading, justify="right")
    for error, name in product(dict.fromkeys(row.max_error for row in rows), names):
        by_name = {of: {(r.picture, r.crc): r for r in rows if (r.codec, r.max_error) == (of, error)} for of in names}
        own, first = by_name[name], by_name[names[0]]
        logs = [math.log(first[picture].bytes / row.bytes) for picture, row in own.items() if picture in first]
        change = 100 * math.expm1(sum(logs) / len(logs)) if logs and name != names[0] else math.nan
        if own:
            encode, decode = (_median_pace(own.values(), way) for way in ("encode_seconds", "decode_seconds"))
            cells = (_cell(change, "+.1f"), _cell(encode, ".2f"), _cell(decode, ".3f"))
            means.add_row(name, f"{error:g}", str(len(own)), *cells)
    _print(console, f"Bytes of {names[0]} against each, mean; processor seconds, median", means)


def _median_pace(rows: Iterable[LosslessRow], way: str) -> float:
    """Seconds a megapixel; not-a-number where the system does not tell."""
    known = ((getattr(row, way), row.width * row.height / 1e6) for row in rows)
    return statistics.median(math.nan if seconds is None else seconds / size for seconds, size in known)


def _print(console: Console, title: str, table: Table) -> None:
    """The title on a line of its own: rich would fold it to the width of a narrow table."""
    console.print(title, style="bold", highlight=False)
    console.print(table)


def _rate_table(measure: str, means: dict[str, dict[float, tuple[float, int]]], count: int) -> Table:
    shown, form = MEASURES[measure].shown, ".1f" if measure == "ssimulacra2" else ".2f"
    table = Table("codec")
    for rate in RATES:
        table.add_column(f"{rate:g} bpp", justify="right")
    for name, at in means.items():
        cells = (_cell(shown(value) if reached == count else math.nan, form) for value, reached in at.values())
        table.add_row(name, *cells)
    return table


def _title(comparison: Comparison) -> str:
    if is_sgi(comparison.test):
        return f"BD-rate in % of {comparison.test} against"
    return f"BD-rate in % against {comparison.anchor} of"


def _delta_table(comparisons: list[Comparison]) -> Table:
    """A column for each other codec: the means by each measure, below the BD-rates of pictures by those `AT_RATES`."""
    table = Table("picture")
    others = list(dict.fromkeys(map(_other, comparisons)))
    for other in others:
        table.add_column(other, justify="right")
    for measure in dict.fromkeys(comparison.measure for comparison in comparisons):
        own = {_other(comparison): comparison for comparison in comparisons if comparison.measure == measure}
        pictures = dict.fromkeys(name for comparison in own.values() for name in comparison.rates)
        if measure in AT_RATES:
            table.add_section()
        for picture in pictures if measure in AT_RATES else ():
            deltas = (own[other].rates.get(picture) if other in own else None for other in others)
            table.add_row(picture, *(_cell(delta.value if delta else math.nan, "+.1f") for delta in deltas))
        means = (_mean_cell(own[other]) if other in own else "–" for other in others)
        table.add_row(f"mean, {measure}", *means)
    return table


def _other(comparison: Comparison) -> str:
    return comparison.anchor if is_sgi(comparison.test) else comparison.test


def _mean_cell(comparison: Comparison) -> str:
    known = sum(delta.reason is None for delta in comparison.rates.values())
    some = "" if known == len(comparison.rates) else f" (of {known})"
    low, high = comparison.interval
    ends = "" if math.isnan(low) else f" ({low:+.1f} to {high:+.1f})"
    return _cell(comparison.mean_rate, "+.1f") + ends + some


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
