"""The table of large pictures: a row for each picture, effort of sgi and codec."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from benchmarks.large.notes import Trip

__all__ = ["LargeRow", "failed_row", "read_rows", "report", "row_of", "write_rows"]


@dataclass(frozen=True)
class LargeRow:
    """Figures of one codec at the PSNR that sgi has at `effort`. Times and memory are those of whole processes;
    `equal_bpp` is the rate at exactly sgi's PSNR. NaN for what a codec does not have.
    """

    picture: str
    width: int
    height: int
    codec: str
    effort: int
    settings: str = ""
    version: str = ""
    bytes: float = math.nan
    bpp: float = math.nan
    psnr: float = math.nan
    equal_bpp: float = math.nan
    encode_seconds: float = math.nan
    encode_per_megapixel: float = math.nan
    encode_cpu: float = math.nan
    encode_mib: float = math.nan
    decode_seconds: float = math.nan
    decode_per_megapixel: float = math.nan
    decode_cpu: float = math.nan
    decode_mib: float = math.nan
    region_seconds: float = math.nan
    region_mib: float = math.nan
    region_bytes: float = math.nan
    overview_seconds: float = math.nan
    overview_mib: float = math.nan
    overview_bytes: float = math.nan
    note: str = ""


def row_of(
    picture: Path, size: tuple[int, int], codec: str, effort: int, trip: Trip, equal_bytes: float, note: str
) -> LargeRow:
    """The row of a trip; `size` is columns and rows."""
    pixels = size[0] * size[1]
    values: dict[str, Any] = {"region_bytes": trip.region_bytes, "overview_bytes": trip.overview_bytes}
    for name in ("encode", "decode", "region", "overview"):
        run = getattr(trip, name)
        if run is not None:
            values |= {f"{name}_seconds": run.seconds, f"{name}_mib": run.peak}
            if name in ("encode", "decode"):
                values |= {f"{name}_per_megapixel": run.seconds / pixels * 1e6, f"{name}_cpu": run.cpu}
    rates = {"bytes": trip.bytes, "bpp": 8 * trip.bytes / pixels, "equal_bpp": 8 * equal_bytes / pixels}
    known: dict[str, Any] = {
        name: float(value) for name, value in (values | rates | {"psnr": trip.psnr}).items() if value is not None
    }
    return LargeRow(
        picture.stem, *size, codec, effort, settings=trip.settings, version=trip.version, note=note, **known
    )


def failed_row(picture: Path, size: tuple[int, int], codec: str, effort: int, reason: str) -> LargeRow:
    """The row of a codec that refused or failed."""
    return LargeRow(picture.stem, *size, codec, effort, note=reason)


def write_rows(rows: Sequence[LargeRow], path: Path) -> None:
    """The rows as tab-separated values; empty for NaN."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, delimiter="\t", lineterminator="\n")
        writer.writerow(field.name for field in fields(LargeRow))
        for row in rows:
            writer.writerow(_text(getattr(row, field.name)) for field in fields(LargeRow))


def _text(value: float | str) -> str:
    if isinstance(value, str):
        return " ".join(value.split())
    return "" if math.isnan(value) else f"{value:.0f}" if float(value).is_integer() else f"{value:.5g}"


def read_rows(path: Path) -> list[LargeRow]:
    """The rows of such a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return [_row(line) for line in csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_MINIMAL)]


def _row(line: dict[str, str]) -> LargeRow:
    values: dict[str, Any] = {}
    for field in fields(LargeRow):
        text = line[field.name]
        if field.type == "str":
            values[field.name] = text
        else:
            values[field.name] = int(text) if field.type == "int" else float(text or "nan")
    return LargeRow(**values)


_COLUMNS = {
    "bpp": "equal_bpp",
    "PSNR": "psnr",
    "encode, s": "encode_seconds",
    "s/MP": "encode_per_megapixel",
    "MiB": "encode_mib",
    "decode, s": "decode_seconds",
    "MiB ": "decode_mib",
    "region, s": "region_seconds",
    "overview, s": "overview_seconds",
}


def report(rows: Sequence[LargeRow]) -> str:
    """A table in Markdown, then notes. Its bpp is `equal_bpp`."""
    lines = ["| picture | MP | effort | codec | " + " | ".join(map(str.strip, _COLUMNS)) + " |"]
    lines.append("|---|---:|---:|---|" + "---:|" * len(_COLUMNS))
    for row in rows:
        cells = [row.picture, f"{row.width * row.height / 1e6:.1f}", str(row.effort), row.codec]
        cells += [_cell(name, getattr(row, name)) for name in _COLUMNS.values()]
        lines.append("| " + " | ".join(cells) + " |")
    notes = [f"- {row.picture}, effort {row.effort}, {row.codec}: {row.note}" for row in rows if row.note]
    return "\n".join([*lines, "", *notes])


def _cell(name: str, value: float) -> str:
    if math.isnan(value):
        return ""
    if name == "psnr":
        return f"{value:.2f}"
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"
