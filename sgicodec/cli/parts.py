"""Where the bytes of a stream went."""

from __future__ import annotations

from collections.abc import Mapping

import click


def metadata_bytes(chunks: Mapping[str, int]) -> dict[str, int]:
    """Bytes of the metadata that a stream carries, frame included, by the name of each kind."""
    from sgicodec.bitstream.chunks import METADATA

    return {field: chunks[letter] for field, letter in METADATA.items() if letter in chunks}


def all_parts(tile: Mapping[str, float], chunks: Mapping[str, int], size: int) -> dict[str, float]:
    """Bytes of every part of a stream of `size` bytes, to which they sum, from those of its tile and of its chunks.

    What is neither model nor metadata is the container: header, frames, checks.
    """
    from sgicodec.bitstream.chunks import CHUNKS

    own = [kind for kind in CHUNKS if kind.metadata is not None or kind.name in ("overview", "residual")]
    model = {name: part for name, part in tile.items() if name != "check"}
    metadata = {kind.name: float(chunks[kind.letter]) for kind in own if kind.letter in chunks}
    return model | {"container": size - sum(model.values()) - sum(metadata.values())} | metadata


def chunk_parts(chunks: Mapping[str, int], size: int) -> dict[str, float]:
    """The same without a look into the tiles."""
    shown = {"tiles": float(chunks.get("T", 0))} | ({"index": float(chunks["X"])} if "X" in chunks else {})
    return all_parts(shown, chunks, size)


def whole_bytes(parts: Mapping[str, float]) -> dict[str, int]:
    """The parts in whole bytes, which sum to the whole bytes of their sum: those with the largest rests are rounded
    up.
    """
    floors = {name: int(size // 1) for name, size in parts.items()}
    left = round(sum(parts.values())) - sum(floors.values())
    for name in sorted(parts, key=lambda name: floors[name] - parts[name])[:left]:
        floors[name] += 1
    return floors


def print_parts(parts: Mapping[str, float], err: bool = False) -> None:
    """One line per part with its whole bytes, as in JSON, and its share of the sum, which ends the table."""
    total, shown = sum(parts.values()), whole_bytes(parts)
    width = max(len(name) for name in ("total", *parts))
    for name, size in {**parts, "total": total}.items():
        whole = shown.get(name, round(total))
        click.echo(f"  {name:<{width}}  {whole:>12,}  {100 * size / total:>5.1f} %", err=err)
