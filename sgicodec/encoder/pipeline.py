"""From a picture to a stream, in one tile or in several."""

from __future__ import annotations

import io
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, BinaryIO, TypeVar

from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.interfaces import Finished, Runner, Task, Version
from sgicodec.encoder.overview import overview_picture, overview_settings, takes_overview
from sgicodec.encoder.passes import TilePasses
from sgicodec.encoder.plan import Plan, Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile_encoder import Encoded, Encoding, empty_pixels
from sgicodec.encoder.tile_weight import tile_weight
from sgicodec.encoder.tile_work import EncodedTile, FitTask, Start
from sgicodec.encoder.time_budget import TimeShares
from sgicodec.encoder.to_target import TargetEncoder
from sgicodec.errors import TargetMissedError
from sgicodec.metrics.distortion import squared_error
from sgicodec.model.tile_grid import Rect
from sgicodec.picture import Picture

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["draw_small", "encode", "window_of"]

Result = TypeVar("Result")


def encode(
    picture: Picture,
    settings: EncodeSettings | None = None,
    on_progress: Callable[[Progress], bool] | None = None,
    started: float | None = None,
    device: Device = ALL_CORES,
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
        return _encode_tiles(picture, plan, on_progress, started, device)
    masked = plan.header.masked if empty_pixels(picture, plan.header.masked).any() else None
    plan = replace(plan, header=replace(plan.header, masked=masked))
    encoding = Encoding(picture, plan, started, device)
    goal = settings.rate_target(picture.width * picture.height)
    return encoding.run(on_progress) if goal is None else TargetEncoder(encoding, goal).run(on_progress)


def window_of(picture: Picture, rect: Rect) -> Picture:
    """The part of a picture in memory that a tile covers."""
    x, y, width, height = rect
    return replace(picture, pixels=picture.pixels[y : y + height, x : x + width])


def _encode_tiles(
    picture: Picture, plan: Plan, on_progress: Callable[[Progress], bool] | None, started: float, device: Device
) -> Encoded:
    """Raises as `encode`."""
    grid = plan.header.grid
    fits = 0

    def watched(task: FitTask) -> FitTask:
        nonlocal fits
        before, fits = fits, fits + 1

        def watch(progress: Progress) -> bool:
            if on_progress is None:
                return True
            total = max(grid.count, before + 1) * progress.steps
            return on_progress(replace(progress, step=before * progress.steps + progress.step, steps=total))

        return replace(task, on_progress=watch)

    def runner(
        task: Task[Result], numbers: Sequence[int], start: Callable[[int], Start], window: Picture | None = None
    ) -> Iterator[tuple[int, Result]]:
        for number in numbers:
            done: Task[Result] = watched(task) if isinstance(task, FitTask) else task  # type: ignore[assignment]
            yield number, done(number, window or window_of(picture, grid.rect(number)), start(number), device)

    def error_of(file: BinaryIO) -> float:
        with open_stream(file, device) as stream:
            return squared_error(picture, stream.picture())

    kept, buffer, limit = _Kept(), io.BytesIO(), plan.settings.time_limit
    shares = None
    if limit is not None:
        weigh = partial(_weight, picture, plan)
        shares = TimeShares(grid, started + limit, workers=1, decoders=0, weigh=weigh)
    small = draw_small(plan, lambda *window: window_of(picture, window), runner)
    found = TilePasses(plan, runner, kept, _Nobody(), error_of, shares, small).run()
    tiles = map(kept.payload, found.chosen)
    write_stream(buffer, found.plan.header, plan.software, plan.metadata, tiles, found.overview)
    encoded = _summary(buffer.getvalue(), found, [kept.tiles[version] for version in found.chosen])
    if found.missed is not None:
        raise TargetMissedError(found.missed, encoded)
    return encoded


@dataclass(frozen=True)
class _OverviewTask:
    """Encodes a picture as a stream of its own."""

    settings: EncodeSettings

    def __call__(self, number: int, window: Picture, start: Start, device: Device) -> bytes:
        """The stream of `window`."""
        return encode(window, self.settings, device=device).data


def draw_small(
    plan: Plan, read: Callable[[int, int, int, int], Picture], runner: Runner
) -> Callable[[float], bytes] | None:
    """What makes the overview of a stream whose tiles are fitted at a λ, if it is to have one. read: as in
    `overview_picture`.
    """

    def drawn(lmbda: float) -> bytes:
        task = _OverviewTask(overview_settings(plan, lmbda))
        return dict(runner(task, [0], lambda _: Start(), overview_picture(plan, read)))[0]

    return drawn if takes_overview(plan) else None


def _weight(picture: Picture, plan: Plan, number: int) -> float:
    return tile_weight(window_of(picture, plan.header.grid.rect(number)), plan)


class _Kept:
    """Tiles in memory."""

    def __init__(self) -> None:
        self.tiles: dict[Version, EncodedTile] = {}
        self._numbers: dict[str, float] = {}
        self._blobs: dict[str, bytes] = {}

    def add(self, version: Version, tile: EncodedTile) -> None:
        self.tiles[version] = tile

    def payload(self, version: Version) -> bytes:
        return self.tiles[version].payload

    def kept(self, name: str, made: Callable[[], bytes]) -> bytes:
        if name not in self._blobs:
            self._blobs[name] = made()
        return self._blobs[name]

    def remembered(self, name: str, found: Callable[[], float]) -> float:
        if name not in self._numbers:
            self._numbers[name] = found()
        return self._numbers[name]


class _Nobody:
    """Is told in vain."""

    def begin(self, name: str, numbers: Sequence[int], there: dict[int, EncodedTile]) -> None: ...

    def done(self, number: int, tile: EncodedTile | None) -> None: ...


def _summary(data: bytes, found: Finished, tiles: list[EncodedTile]) -> Encoded:
    """The figures of a stream from those of its tiles."""
    parts: Counter[str] = Counter()
    for tile in tiles:
        parts.update(tile.part_bytes)
    if found.overview:
        parts["overview"] = len(found.overview)
    seeds = sum(tile.seeds for tile in tiles)
    return Encoded(data, dict(parts), seeds, seeds * found.plan.header.spec.per_seed, found.lmbda)
