"""From a picture to a stream: settings, fit, symbols, chunks."""

from __future__ import annotations

import io
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.assembly import write_stream
from sgicodec.bitstream.header import MAX_CHANNELS, MAX_SIDE, MAX_TILES, Header, Masked
from sgicodec.bitstream.limits import check_model
from sgicodec.bitstream.prior import PRIORS, load_prior
from sgicodec.bitstream.tile import DECODER_SHIFT, TileModel, write_tile
from sgicodec.bitstream.tile_chunk import TileChunk, encode_tile_chunk
from sgicodec.decoder import open_stream
from sgicodec.encode_settings import EncodeSettings
from sgicodec.errors import LimitError, PictureError, TargetMissedError, UsageError
from sgicodec.fill import fill
from sgicodec.fit.settings import quality_index, steered
from sgicodec.fit.steering import Goal, Measured, Steering, first_lmbda
from sgicodec.image import Picture, comparable, full_range, nodata_mask, to_unit
from sgicodec.image.picture import Metadata, alpha_index
from sgicodec.metrics import psnr
from sgicodec.model.base import fit_base, render_base
from sgicodec.model.context import input_count
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.layout import adaptive_layout, uniform_layout
from sgicodec.model.processor import Processor
from sgicodec.model.quantize import step_fixed, step_index
from sgicodec.model.spec import ModelSpec, default_spec, paper_spec
from sgicodec.refine import Refiner, RefineSettings, can_refine
from sgicodec.tiles import Rect, TileGrid
from sgicodec.trim import MOST_SHIFT, coarser, trim
from sgicodec.version import __version__

if TYPE_CHECKING:
    from sgicodec.fit.settings import FitSettings
    from sgicodec.fit.trainer import Fitted, Progress

__all__ = [
    "FAMILY",
    "EncodeSettings",
    "Encoded",
    "EncodedTile",
    "Plan",
    "Shape",
    "base_layer",
    "encode",
    "encode_tile",
    "fit_lmbda",
    "fit_steps",
    "keep_to_one_torch_thread",
    "stream_plan",
]

FAMILY = 1
"""Frequency tables of the default profile: Laplace."""

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Encoded:
    """A finished stream. part_bytes: what each part of the tile costs; seeds, gaussians: how many there are."""

    data: bytes
    part_bytes: dict[str, float]
    seeds: int
    gaussians: int
    lmbda: float


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
    masked = plan.header.masked if _empty(picture, plan.header.masked).any() else None
    plan = replace(plan, header=replace(plan.header, masked=masked))
    return _Encoding(picture, plan, started).run(on_progress)


@dataclass(frozen=True)
class Shape:
    """What is known of a picture before its pixels are: as in `Picture`, `bands` their number."""

    width: int
    height: int
    channels: str
    bands: int
    dtype: np.dtype[Any]
    sample_range: tuple[float, float]
    metadata: Metadata
    nodata: float | None

    @classmethod
    def of(cls, picture: Picture) -> Shape:
        """That of a picture in memory."""
        bands, dtype = picture.pixels.shape[2], picture.pixels.dtype
        shape = (picture.width, picture.height, picture.channels, bands, dtype)
        return cls(*shape, picture.sample_range, picture.metadata, picture.nodata)


@dataclass(frozen=True)
class Plan:
    """What the tiles of a stream have in common. settings: those of each tile; software: what chunk `s` says."""

    header: Header
    settings: EncodeSettings
    software: bytes
    metadata: Metadata | None
    place_of_windows: Metadata
    """What tells the nodata value of windows."""


def stream_plan(shape: Shape, settings: EncodeSettings) -> Plan:
    """The header and settings of a picture's tiles. Raises as `encode`."""
    spec, grid = _spec(settings, shape.bands), settings.grid(shape.width, shape.height)
    _check(shape, spec, grid)
    fit = _fit_settings(settings)
    header = Header(
        *(shape.width, shape.height, shape.channels, str(shape.dtype), shape.sample_range, settings.profile, spec),
        quality=quality_index(fit.lmbda),
        family=0 if spec.layout == "uniform" else FAMILY,
        tile=grid.tile,
        apron=grid.apron,
        masked="nodata" if shape.nodata is not None else "transparent" if alpha_index(shape.channels) else None,
        nodata=shape.nodata or 0.0,
    )
    if grid.tile and (settings.asked() or settings.time_limit is not None):
        what = "a size or PSNR to end at" if settings.asked() else "a time limit"
        raise UsageError(f"{what} is for a single tile; give a quality or λ, or --tile 0")
    metadata = shape.metadata if settings.metadata else None
    return Plan(header, settings, _software(settings, fit), metadata, Metadata(geo=shape.metadata.geo))


def fit_steps(settings: EncodeSettings) -> int:
    """Optimisation steps of a fit without a time limit."""
    return _fit_settings(settings).steps


def fit_lmbda(settings: EncodeSettings) -> float:
    """λ of a fit without a goal."""
    return _fit_settings(settings).lmbda


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

    tile = _Encoding(window, replace(plan, header=header.of_tile(number), settings=settings), started)
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


def _empty(picture: Picture, masked: Masked | None) -> NDArray[np.bool_]:
    """Which pixels [H, W] need not be coded."""
    if masked == "transparent":
        return np.asarray(picture.pixels[..., -1] == 0)
    return nodata_mask(picture)


class _Encoding:
    """One picture, or one tile, on its way to a stream."""

    def __init__(self, picture: Picture, plan: Plan, started: float) -> None:
        self.started, self.picture, self.plan, self.settings = started, picture, plan, plan.settings
        self.spec = spec = plan.header.spec
        self.unit = np.ascontiguousarray(to_unit(picture).transpose(2, 0, 1))
        self.empty: NDArray[np.bool_] | None = None
        if plan.header.masked is not None:
            empty = _empty(picture, plan.header.masked)
            self.empty = empty if empty.any() else None
            if self.empty is not None:
                self.unit = fill(self.unit, self.empty)
        self.goal = self.settings.goal(picture.width * picture.height)
        self.tries = 0
        self.fit = _fit_settings(self.settings)
        if self.goal is not None:
            self.fit = steered(self.fit)
            _, _, detail = base_layer(spec, self.unit, self.fit.lmbda)
            lmbda = first_lmbda(self._fit_goal(self.goal), detail, self.fit, self._extra())
            self.fit = replace(self.fit, lmbda=lmbda)
        self._begin(self.fit.lmbda)

    def _begin(self, lmbda: float) -> None:
        self.tries += 1
        self.fit = replace(self.fit, lmbda=lmbda)
        self.base_step, self.base, self.target = base_layer(self.spec, self.unit, lmbda)

    def chunk(
        self, number: int, on_progress: Callable[[Progress], bool] | None
    ) -> tuple[TileChunk, dict[str, float], int]:
        """The parts of chunk T without goals, the bytes of each, and the number of seeds."""
        if self._holds_nothing():
            return TileChunk(number, self.empty, None), {}, 0
        fitted, header = self._fitted(on_progress)
        model = self._searched(header, self._model(fitted), fitted.lmbda)
        payload, parts = _written(header, model)
        return TileChunk(number, self.empty, payload), parts, len(model.layout)

    def _holds_nothing(self) -> bool:
        return self.empty is not None and bool(self.empty.all())

    def run(self, on_progress: Callable[[Progress], bool] | None) -> Encoded:
        """Fits and writes. Raises TargetMissedError, with the nearest stream, where a goal cannot be reached."""
        if self._holds_nothing():
            return Encoded(self._assembled(self.plan.header, None)[0], {}, 0, 0, self.fit.lmbda)
        if self.goal is None:
            fitted, header = self._fitted(on_progress)
            return self._encoded(header, self._searched(header, self._model(fitted), fitted.lmbda), fitted.lmbda)
        goal, ended = self.goal, False

        def watch(state: Progress) -> bool:
            nonlocal ended
            ended = on_progress is not None and not on_progress(state)
            return not ended

        encoded, measured = self._at_goal(goal, *self._fitted(watch))
        little = goal.psnr is not None and goal.excess(measured) > -_LITTLE
        if goal.is_missed(measured) and little and not ended and self.settings.time_limit is None:
            # Seeds were dropped that were needed: once more, from where λ should have begun, and below.
            self._begin(0.5 * math.sqrt(self.fit.lmbda * encoded.lmbda))
            again = self._at_goal(goal, *self._fitted(watch))
            encoded, measured = max((encoded, measured), again, key=lambda one: one[1].psnr)
        if goal.is_missed(measured):
            raise TargetMissedError(_regret(goal, measured), encoded)
        return encoded

    def _at_goal(self, goal: Goal, fitted: Fitted, header: Header) -> tuple[Encoded, Measured]:
        """Trims the fit to what the search for symbols will bring to the goal, and searches until it is there."""
        lmbda = fitted.lmbda
        shift = trim(self._fit_goal(goal), lambda shift: self._measured(header, self._model(fitted, shift), lmbda)[1])
        if not self._searches:
            return self._measured(header, self._model(fitted, shift), lmbda)
        found: list[tuple[Encoded, Measured]] = []
        while not found or (goal.is_missed(found[-1][1]) and len(found) < _MOST_SHIFTS):
            found.append(self._searched_to(goal, header, self._model(fitted, shift), lmbda))
            excess = goal.excess(found[-1][1])
            shift += round(_SHIFTS_PER_OCTAVE * excess) + (4 if excess > 0 else -4)
            shift = max(-MOST_SHIFT, min(MOST_SHIFT, shift))
        sound = [one for one in found if not goal.is_missed(one[1])]
        return min(sound or found, key=lambda one: abs(goal.excess(one[1])))

    def _searched_to(self, goal: Goal, header: Header, model: TileModel, lmbda: float) -> tuple[Encoded, Measured]:
        """Searches at several λ."""
        refiner = self._refiner(header, model, lmbda)
        found: dict[float, tuple[Encoded, Measured]] = {}
        octaves, gain = 0.0, _SEARCH_GAIN
        while octaves not in found and len(found) < _MOST_SEARCHES:
            found[octaves] = self._measured(header, refiner.at(lmbda * 2.0**octaves, until=self._end).model, lmbda)
            if goal.is_met(found[octaves][1]):
                return found[octaves]
            if len(found) > 1:
                (a, first), (b, last) = list(found.items())[-2:]
                gain = min(4.0, max(0.5, (b - a) / ((goal.excess(first[1]) - goal.excess(last[1])) or 1.0)))
            octaves += max(-1.0, min(1.0, gain * goal.excess(found[octaves][1])))
        sound = [one for one in found.values() if not goal.is_missed(one[1])]
        return min(sound or found.values(), key=lambda one: abs(goal.excess(one[1])))

    def _refiner(self, header: Header, model: TileModel, lmbda: float) -> Refiner:
        settings = RefineSettings.for_steps(self.fit.steps)
        return Refiner(header, model, self.unit, lmbda, settings, Processor(self.fit.threads))

    @property
    def _end(self) -> float:
        """When the time limit is over, a value of time.monotonic()."""
        limit = self.settings.time_limit
        return math.inf if limit is None else self.started + limit

    @property
    def _searches(self) -> bool:
        return self.settings.refine and can_refine(self.spec)

    def _fit_goal(self, goal: Goal) -> Goal:
        """Where a fit has to end so that the search for symbols ends at the goal."""
        if not self._searches:
            return goal
        if goal.bytes is not None:
            return Goal(bytes=goal.bytes / _SEARCHED_BYTES)
        return Goal(psnr=(goal.psnr or 0.0) - _SEARCHED_DECIBELS)

    def _fitted(self, on_progress: Callable[[Progress], bool] | None) -> tuple[Fitted, Header]:
        from sgicodec.fit.trainer import Trainer

        spec, fit = self.spec, self.fit
        _, height, width = self.target.shape
        if spec.layout == "uniform":
            count = fit.seeds or max(1, round(width * height / 400))
            layout = uniform_layout(width, height, count, np.random.default_rng(fit.seed))
        else:
            layout = adaptive_layout(self.target, fit.split * fit.lmbda * fit.seed_bits)
        family = 0 if spec.layout == "uniform" else FAMILY
        networks = load_prior(spec) if spec.context.prior else None
        steering = None
        if self.goal is not None:
            goal = self._fit_goal(self.goal)
            steering = Steering(goal, fit.lmbda, self._overhead(), leaps=self.tries == 1)
        with _one_torch_thread():
            trainer = Trainer(
                spec,
                fit,
                self.target,
                layout,
                family,
                networks,
                steering=steering,
                measure=lambda f: self._measured(self._header(f, family), self._model(f), f.lmbda)[1],
                seconds=self._seconds(),
            )
            fitted = trainer.run(on_progress)
            return fitted, self._header(fitted, family)

    def _overhead(self) -> float:
        """About what the stream holds beside its seeds, in bytes."""
        return _OVERHEAD + _BASE_BYTES * self.target.size / max(1, self.spec.base_cell**2) + self._extra()

    def _extra(self) -> float:
        """Of that, what most streams do not have: metadata and networks of their own."""
        context = self.spec.context
        inputs = [input_count(self.spec, step) for step in range(len(context.steps))]
        weights = 0 if context.prior else context.hidden * sum(inputs)
        blobs = _blobs(self.picture, self.settings)
        return sum(len(blob) for blob in blobs.values()) + _WEIGHT_BYTES * weights

    def _seconds(self) -> float | None:
        """What is left for the fit itself."""
        if self.settings.time_limit is None:
            return None
        coding: float = _CODING_SECONDS * (2 if self.goal is None else 8) * (0.2 + self.target[0].size / 1e6)
        left = self.settings.time_limit - (time.monotonic() - self.started)
        searching: float = _SEARCHING_SHARE * left if self._searches else 0.0
        return max(0.5 * left, left - coding - searching, 1e-3)

    def _header(self, fitted: Fitted, family: int) -> Header:
        return replace(self.plan.header, quality=fitted.quality, family=family)

    def _model(self, fitted: Fitted, shift: int = 0) -> TileModel:
        return TileModel(
            fitted.layout,
            fitted.plan,
            self.base_step,
            self.base,
            {name: np.rint(w * 2.0**DECODER_SHIFT).astype(np.int64) for name, w in fitted.decoders.items()},
            coarser(fitted.networks, shift) if shift else fitted.networks,
            fitted.hash_bits,
            fitted.attributes,
        )

    def _searched(self, header: Header, model: TileModel, lmbda: float) -> TileModel:
        if not self._searches:
            return model
        return self._refiner(header, model, lmbda).at(lmbda, until=self._end).model

    def _encoded(self, header: Header, model: TileModel, lmbda: float) -> Encoded:
        payload, parts = _written(header, model)
        data, chunk_bytes = self._assembled(header, payload)
        if header.masked is not None:
            parts["mask"] = chunk_bytes - len(payload)
        seeds = len(model.layout)
        return Encoded(data, parts, seeds, seeds * self.spec.per_seed, lmbda)

    def _measured(self, header: Header, model: TileModel, lmbda: float) -> tuple[Encoded, Measured]:
        encoded, quality = self._encoded(header, model, lmbda), math.inf
        if self.goal is not None and self.goal.psnr is not None:
            decoded = open_stream(encoded.data).picture(threads=self.settings.threads)
            shown = np.array(True) if self.empty is None else ~self.empty[..., None]
            quality = psnr(*(np.where(shown, comparable(p), 0) for p in (self.picture, decoded)))
        return encoded, Measured(len(encoded.data), quality)

    def _assembled(self, header: Header, model: bytes | None) -> tuple[bytes, int]:
        """The stream, and the bytes of its tile's payload."""
        buffer, chunk = io.BytesIO(), encode_tile_chunk(header, TileChunk(0, self.empty, model))
        write_stream(buffer, header, self.plan.software, self.plan.metadata, [chunk])
        return buffer.getvalue(), len(chunk)


def _written(header: Header, model: TileModel) -> tuple[bytes, dict[str, float]]:
    """The payload of a model, and the bytes of each part."""
    payload, walk = write_tile(header, model)
    return payload, {name: bits / 8 for name, bits in walk.bits.items()}


_MOST_SEARCHES, _MOST_SHIFTS = 4, 3
_SHIFTS_PER_OCTAVE = 60
"""Units by which a trim shifts steps for what an octave of λ does to the bytes, about."""
_SEARCHED_BYTES, _SEARCHED_DECIBELS = 0.965, 0.22
"""What the search for symbols leaves of the bytes, and adds to the PSNR, on photographs whose fit was steered."""
_SEARCH_GAIN = 1.5
"""Octaves of λ that a search must move for each octave that a fit would have to."""
_OVERHEAD, _BASE_BYTES, _WEIGHT_BYTES = 250.0, 0.4, 1.2
"""About what a stream holds beside its seeds: header, steps and differences; for each number of the base layer; for
each weight of an own network.
"""
_LITTLE = 1.0
"""Octaves of λ by which a PSNR may be missed for a second fit."""
_CODING_SECONDS = 0.6
"""Of one stream of a megapixel, generously."""
_SEARCHING_SHARE = 0.12
"""Of the time that is left for fit and search together."""


def _regret(goal: Goal, measured: Measured) -> str:
    if goal.bytes is not None:
        return f"no stream of at most {goal.bytes:.0f} bytes was found; the smallest has {measured.bytes:.0f}"
    return f"no stream of {goal.psnr:g} dB was found; the best reaches {measured.psnr:.2f} dB"


def _check(shape: Shape, spec: ModelSpec, grid: TileGrid) -> None:
    bands, sides = shape.bands, (shape.width, shape.height)
    if bands > MAX_CHANNELS or max(sides) > MAX_SIDE:
        size = f"{sides[0]}×{sides[1]} pixels of {bands} channels"
        raise PictureError(f"{size}; a stream holds at most {MAX_CHANNELS} channels and {MAX_SIDE} pixels a side")
    if grid.count > MAX_TILES:
        raise UsageError(f"tile {grid.tile}: {grid.count} tiles; a stream holds at most {MAX_TILES}")
    try:
        check_model(spec, *grid.rect(0)[2:])
    except LimitError as error:
        raise PictureError(str(error)) from error
    if shape.dtype.kind == "u" and shape.sample_range != full_range(shape.dtype):
        raise UsageError("integer samples span their whole type; only floating-point pictures have another range")


def _spec(settings: EncodeSettings, channels: int) -> ModelSpec:
    if settings.profile == "paper":
        return paper_spec(channels, settings.per_seed or 10, settings.features or 50)
    prior = settings.prior if settings.prior is not None else max(PRIORS, default=0)
    return default_spec(channels, settings.per_seed or 1, prior)


def _fit_settings(settings: EncodeSettings) -> FitSettings:
    from sgicodec.fit.settings import EFFORTS, PAPER_STEPS, default_settings, lmbda_of_quality, paper_settings

    if settings.profile == "paper":
        lmbda = 0.001 if settings.lmbda is None else settings.lmbda
        fit = paper_settings(lmbda, settings.levels or 3, settings.steps or PAPER_STEPS)
        fit = replace(fit, seeds=settings.seeds)
    else:
        lmbda = lmbda_of_quality(settings.quality) if settings.lmbda is None else settings.lmbda
        fit = default_settings(max(lmbda, 1e-9), settings.steps or EFFORTS[settings.effort])
    return replace(fit, seed=settings.seed, threads=settings.threads)


def base_layer(spec: ModelSpec, unit: F32, lmbda: float) -> tuple[int, NDArray[np.int64], F32]:
    """Step index, integer grid, and what is left of the picture."""
    channels, height, width = unit.shape
    if not spec.base_cell:
        return 0, np.zeros((channels, 0, 0), np.int64), unit
    opponent = np.array(colour_matrix(channels))
    # One colour stands for cell² pixels; half of its energy is its own: q² = 6 λ / (E ln 2).
    index = int(step_index(math.sqrt(12 * lmbda / math.log(2)) / spec.base_cell))
    step = float(step_fixed(np.array(index))) * 2.0**-24
    grid = fit_base(np.tensordot(opponent, unit, axes=1).astype(np.float32), spec.base_cell)
    base = np.rint(grid / step).astype(np.int64)
    colours = np.tensordot(opponent.T, base * step, axes=1)
    drawn = render_base(colours, spec.base_cell, np.arange(width) + 0.5, np.arange(height) + 0.5)
    return index, base, unit - drawn


def keep_to_one_torch_thread() -> None:
    """For a process that fits several tiles at once in threads of its own: see `_one_torch_thread`."""
    import torch

    torch.set_num_threads(1)


@contextmanager
def _one_torch_thread() -> Iterator[None]:
    """With more threads torch's sums, powers and scattered additions depend on their number, some even on chance.

    The rasteriser, where the time goes, gives the same for any number.
    """
    import torch

    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


def _software(settings: EncodeSettings, fit: FitSettings) -> bytes:
    """What chunk `s` says."""
    by_scale = settings.profile == "default"
    asked = settings.asked() or (f"q{settings.quality:g}" if by_scale and settings.lmbda is None else f"l{fit.lmbda:g}")
    took = f"e{settings.effort}" if by_scale and settings.steps is None else f"n{fit.steps}"
    took = took if settings.time_limit is None else f"t{settings.time_limit:g}"
    return f"{__version__} {asked} {took}".encode()


def _blobs(picture: Picture, settings: EncodeSettings) -> dict[str, bytes]:
    """The metadata that the stream keeps, by chunk."""
    metadata = picture.metadata
    blobs = {"i": metadata.icc, "c": metadata.exif, "x": metadata.xmp} if settings.metadata else {}
    return {kind: blob for kind, blob in blobs.items() if blob}
