"""From a picture to a stream, in one tile or in several."""

from __future__ import annotations

import io
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sgicodec.aim import Aim
from sgicodec.assembly import write_stream
from sgicodec.bitstream.tile_chunk import encode_tile_chunk
from sgicodec.encode_settings import EncodeSettings
from sgicodec.encoding import Encoded, Encoding, empty_pixels
from sgicodec.image import Picture
from sgicodec.plan import Plan, Shape, fit_lmbda, stream_plan
from sgicodec.tiles import Rect

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["EncodedTile", "encode", "encode_tile", "summary", "window_of"]


def encode(
    picture: Picture,
    settings: EncodeSettings | None = None,
    on_progress: Callable[[Progress], bool] | None = None,
    started: float | None = None,
) -> Encoded:
    """Fits `picture` and writes the stream. `on_progress` is called after every step; what it returns says whether to
    go on (True) or to finish with what is there. Equal input, settings and version give equal bytes, unless time is
    the limit: it runs from `started` on, a value of time.monotonic(), or from this call.

    Raises TargetMissedError, with the nearest stream, for a size or quality that cannot be reached, PictureError for
    what no stream can hold, UsageError for a range of samples that integers do not have.
    """
    settings = settings or EncodeSettings()
    plan = stream_plan(Shape.of(picture), settings)
    started = time.monotonic() if started is None else started
    if plan.header.tile:
        return _encode_tiles(picture, plan, on_progress)
    masked = plan.header.masked if empty_pixels(picture, plan.header.masked).any() else None
    plan = replace(plan, header=replace(plan.header, masked=masked))
    encoding = Encoding(picture, plan, started)
    goal = settings.goal(picture.width * picture.height)
    return encoding.run(on_progress) if goal is None else Aim(encoding, goal).run(on_progress)


@dataclass(frozen=True)
class EncodedTile:
    """A finished tile. payload: of its chunk; part_bytes, seeds as in `Encoded`; squared_error: of the fit's last step,
    samples in 0..1, over `samples` of them; seconds: that it took; length: of the payload.
    """

    payload: bytes
    part_bytes: dict[str, float]
    seeds: int
    squared_error: float
    samples: int
    seconds: float
    length: int


def encode_tile(
    window: Picture, plan: Plan, number: int, on_progress: Callable[[Progress], bool] | None = None
) -> EncodedTile:
    """Fits tile `number` of a stream of several to its pixels, apron included."""
    header, started = plan.header, time.monotonic()
    settings = plan.settings
    if settings.seeds is not None:
        share = window.width * window.height / (header.width * header.height)
        settings = replace(settings, seeds=max(1, round(settings.seeds * share)))
    last: list[Progress] = []

    def watch(progress: Progress) -> bool:
        last[:] = [progress]
        return on_progress is None or on_progress(progress)

    tile = Encoding(window, replace(plan, header=header.of_tile(number), settings=settings), started)
    chunk, parts, seeds = tile.chunk(number, watch)
    samples = window.pixels.size
    error = samples * 10 ** (-0.1 * last[0].psnr) if last else 0.0
    payload = encode_tile_chunk(header, chunk)
    if header.masked is not None:
        parts["mask"] = len(payload) - len(chunk.model or b"")
    return EncodedTile(payload, parts, seeds, error, samples, time.monotonic() - started, len(payload))


def window_of(picture: Picture, rect: Rect) -> Picture:
    """The part of a picture in memory that a tile covers."""
    x, y, width, height = rect
    return replace(picture, pixels=picture.pixels[y : y + height, x : x + width])


def _encode_tiles(picture: Picture, plan: Plan, on_progress: Callable[[Progress], bool] | None) -> Encoded:
    grid, tiles = plan.header.grid, []
    for number in range(grid.count):

        def watch(progress: Progress, before: int = number) -> bool:
            if on_progress is None:
                return True
            total = grid.count * progress.steps
            return on_progress(replace(progress, step=before * progress.steps + progress.step, steps=total))

        tiles.append(encode_tile(window_of(picture, grid.rect(number)), plan, number, watch))
    buffer = io.BytesIO()
    write_stream(buffer, plan.header, plan.software, plan.metadata, (tile.payload for tile in tiles))
    return summary(buffer.getvalue(), plan, tiles)


def summary(data: bytes, plan: Plan, tiles: list[EncodedTile]) -> Encoded:
    """The figures of a stream from those of its tiles."""
    parts: Counter[str] = Counter()
    for tile in tiles:
        parts.update(tile.part_bytes)
    seeds = sum(tile.seeds for tile in tiles)
    return Encoded(data, dict(parts), seeds, seeds * plan.header.spec.per_seed, fit_lmbda(plan.settings))
