"""The only tile of a stream on its way to a rate target: a size, a PSNR or a score."""

from __future__ import annotations

from sgicodec.encoder.tile.seed_target import best_by_seeds
from sgicodec.encoder.tile.state import Tile
from sgicodec.encoder.tile.texture_target import best_by_texture
from sgicodec.encoder.tile.writing import WrittenTile, network_weights
from sgicodec.rate_control.side_information import network_bytes
from sgicodec.rate_control.target import RateTarget

__all__ = ["write_at_target"]


def write_at_target(tile: Tile, target: RateTarget) -> tuple[WrittenTile, str | None]:
    """The tile that comes nearest to the target, and how it misses that, if it does."""
    best = best_by_texture if tile.spec.texture else best_by_seeds
    written, measured = best(tile, target, _extra_bytes(tile))
    return written, target.miss_message(measured) if target.is_missed(measured) else None


def _extra_bytes(tile: Tile) -> float:
    """Bytes of metadata and of networks that travel in the stream."""
    metadata = tile.plan.metadata
    blobs = () if metadata is None else (metadata.icc, metadata.exif, metadata.xmp)
    return sum(len(blob) for blob in blobs if blob) + network_bytes(network_weights(tile.spec))
