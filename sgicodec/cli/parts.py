"""Where the bytes of a stream went."""

from __future__ import annotations

from collections.abc import Mapping

import click

__all__ = ["all_parts", "print_parts"]

_METADATA = {"i": "ICC profile", "c": "EXIF", "x": "XMP", "g": "place", "o": "overview"}


def all_parts(tile: Mapping[str, float], chunks: Mapping[str, int], size: int) -> dict[str, float]:
    """Bytes of every part of a stream of `size` bytes, to which they sum, from those of its tile and of its chunks.

    What is neither model nor metadata is the container: header, frames, checks.
    """
    model = {name: part for name, part in tile.items() if name != "check"}
    metadata = {name: float(chunks[kind]) for kind, name in _METADATA.items() if kind in chunks}
    return model | {"container": size - sum(model.values()) - sum(metadata.values())} | metadata


def print_parts(parts: Mapping[str, float], err: bool = False) -> None:
    """One line per part with its bytes and its share of the sum, which ends the table."""
    total = sum(parts.values())
    width = max(len(name) for name in ("total", *parts))
    for name, size in {**parts, "total": total}.items():
        click.echo(f"  {name:<{width}}  {size:>12,.0f}  {100 * size / total:>5.1f} %", err=err)
