"""A tile and its state on the way to a stream. Each stage makes the next state; none changes one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sgicodec.arrays import F32, I64
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.effort import Effort
from sgicodec.encoder.input.nodata import OPAQUE, Bare, bare_samples, coded_samples, with_least_masks
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.restoration import Restorer, Strength
from sgicodec.encoder.tile.texture_steps import TUNINGS, Masking, TextureTuning
from sgicodec.metrics.jpeg_grid import jpeg_grid
from sgicodec.metrics.masking_weights import masking_weights
from sgicodec.metrics.psnr import luma
from sgicodec.model.colours import to_channels
from sgicodec.model.spec import ModelSpec
from sgicodec.model.texture_symbols import LAPPED, TextureGrid, TextureIndices, TextureSymbols
from sgicodec.picture import Picture
from sgicodec.profiles.fit_settings import FitSettings
from sgicodec.rdoq import Objective
from sgicodec.rdoq.texture import TextureSearch, colours_for

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress


SEPARATE_COST = 0.98
"""Cost of separate cells in that of lapped ones, by an estimate, below which they are taken. Where both seem equal,
separate ones take 1 to 3 % more (docs/notes/2026-11-texture.md)."""


class TileListener:
    """Who is told of the work on a tile, and may end it. This one ignores all and ends nothing."""

    def stage(self, name: str) -> None:
        """A stage begins."""

    def step(self, progress: Progress) -> bool:
        """A step of a fit is done. Returns whether to go on."""
        return True

    def ending(self) -> bool:
        """Whether to end soon, with the seeds as they are. Asked after a fit."""
        return False


@dataclass
class Watch(TileListener):
    """Tells a listener, and remembers. steps: of the last fit; is_short: whether it was to have more; was_ended:
    whether the listener ended it; fitted_by: the name of what made it, a GPU or the processor, empty before a fit.
    """

    listener: TileListener
    steps: int = 0
    is_short: bool = False
    was_ended: bool = False
    fitted_by: str = ""

    def stage(self, name: str) -> None:
        """As in `TileListener`."""
        self.listener.stage(name)

    def step(self, progress: Progress) -> bool:
        """As in `TileListener`."""
        self.steps, self.is_short = progress.step, progress.step < progress.steps
        self.was_ended = not self.listener.step(progress)
        return not self.was_ended

    def ending(self) -> bool:
        """As in `TileListener`."""
        return self.was_ended or self.listener.ending()


@dataclass(frozen=True)
class Tile:
    """A tile and what is asked for: what stays through all stages. A picture in one tile is one."""

    picture: Picture
    """Its pixels, its overlap with the tiles beside it included."""
    plan: Plan
    """That of the stream."""
    number: int
    """Which of the stream's tiles it is."""
    header: Header
    """What it would have as a picture of its own."""
    settings: EncodeSettings
    """Those of the stream, or its share of them."""
    fit: FitSettings
    """How it is fitted, at the λ of the encode."""
    effort: Effort
    """How much is done to it."""
    unit: F32
    """[C, H, W]: the channels of samples in 0..1, as the model is to show them."""
    empty: NDArray[np.bool_] | None
    """[H, W]: pixels that need not be coded, None for none."""
    alpha: F32 | None
    """[H, W]: opacity that a residual layer shows, so that `unit` is opaque; None where the model shows it."""
    bare: Bare
    """Samples that no model shows."""
    weights: F32 | None
    """[H, W]: what squared errors count, None where all count the same."""
    masking: Masking
    """Of texture, for any steps."""
    grids: tuple[TextureGrid, ...]
    """Those of texture that are tried: of cells that lap over, and that of the JPEG file that it was, if it was one."""
    watch: Watch
    device: Device

    @property
    def spec(self) -> ModelSpec:
        """What kind of model it has."""
        return self.header.spec

    @property
    def is_only(self) -> bool:
        """Whether the stream has no other tile."""
        return not self.plan.header.tile

    @property
    def holds_nothing(self) -> bool:
        """Whether no pixel needs to be coded."""
        return self.empty is not None and bool(self.empty.all())

    @property
    def has_rdoq(self) -> bool:
        """Whether RDOQ follows the fit."""
        return self.settings.rdoq and self.effort.rdoq.passes > 0 and self.spec.plain

    @property
    def texture_lmbda(self) -> float:
        """λ of its texture, which on the way to a target is not that of the encode."""
        stated = self.plan.texture_lmbda if self.spec.texture else None
        return self.fit.lmbda if stated is None else stated

    @property
    def tuning(self) -> TextureTuning:
        """How steps of texture follow from λ."""
        return TUNINGS[self.settings.tuned_for]

    @cached_property
    def restorer(self) -> Restorer:
        """What finds how to restore the tile."""
        tuning = self.tuning
        network = self.header.network or tuning.network
        return Restorer(self.unit, self.empty, network, tuning.worth, self.device)


def tile_of(
    picture: Picture,
    plan: Plan,
    device: Device = ALL_CORES,
    number: int = 0,
    *,
    listener: TileListener | None = None,
) -> Tile:
    """Tile `number` of a stream, whose pixels are `picture`."""
    header = plan.header.of_tile(number) if plan.header.tile else with_least_masks(plan.header, picture)
    settings = plan.settings
    if settings.seeds is not None:
        part = picture.width * picture.height / (plan.header.width * plan.header.height)
        settings = replace(settings, seeds=max(1, round(settings.seeds * part)))
    fit = settings.fit_settings()
    if plan.header.tile:
        fit = replace(fit, colour_step=header.colour_step)
    bare = bare_samples(picture, header)
    unit, empty = coded_samples(picture, header, bare)
    alpha = None
    if plan.exact_alpha:
        alpha = np.clip(unit[-1], 0, 1)
        unit[-1] = OPAQUE
        empty = None if empty is not None and empty.all() else empty  # a tile without a mask has a model
    unit[list(plan.exact_bands)] = 0
    seen = luma(unit.transpose(1, 2, 0), peak=1.0)
    is_visual = settings.tuned_for == "visual"
    weights = masking_weights(seen, empty) if is_visual else None
    grid = jpeg_grid(seen) if header.spec.texture else None
    grids = (LAPPED,) if grid is None else (LAPPED, TextureGrid(True, *grid))
    masking = Masking(TUNINGS[settings.tuned_for], seen if is_visual else None, device, grids)
    unit = np.tensordot(to_channels(header.spec).astype(np.float32), unit, axes=1)
    return Tile(
        picture,
        plan,
        number,
        header,
        settings,
        fit,
        settings.chosen_effort,
        unit,
        empty,
        alpha,
        bare,
        weights,
        masking,
        grids,
        Watch(listener or TileListener()),
        device,
    )


@dataclass(frozen=True)
class Prepared:
    """A tile before its fit."""

    tile: Tile
    fit: FitSettings
    """The tile's, at the λ of its seeds."""
    base_step: int
    """Index of the base layer's step."""
    base: I64
    """[C, rows, columns]: the base layer, in steps."""
    target: F32
    """[C, H, W]: `unit` less the base layer, which is what seeds and texture are to show."""
    weights: F32 | None
    """[H, W]: what squared errors of seeds count: as in the tile, less where texture follows for fewer bits."""


@dataclass(frozen=True)
class TileState(Prepared):
    """A tile from its fit on."""

    header: Header
    """The tile's, with the base colour step of the fit."""
    model: TileModel
    """What a stream will hold: seeds, and texture and restoration once they are found."""
    step_offsets: NDArray[np.int8] | None = None
    """[rows, columns]: by how many quarters of an octave the steps of each superblock of texture are coarser; None for
    none."""

    def with_texture(self, texture: TextureSymbols | None, strength: Strength | None) -> TileState:
        """The tile with this layer, restored with this strength; None for none."""
        restoration = None if texture is None or strength is None else strength.over(texture)
        return replace(self, model=replace(self.model, texture=texture, restoration=restoration))

    def begin_texture(self) -> tuple[TileState, TextureSearch]:
        """The tile with the offsets of its λ, and what searches texture over its seeds as decoders have them: on the
        grid of the JPEG file that it was, where that pays.
        """
        tile = self.tile
        left = Objective(self.header, self.target, tile.device).decoded_residual(self.model)[:, :, : tile.unit.shape[2]]
        steps, grid = self._steps(self.first_step), self._grid_for(left)
        offsets = tile.masking.offsets(steps, grid)
        colours = colours_for(left, steps, self.price, offsets, tile.device, grid)
        search = TextureSearch(left, tile.device, tile.effort.split_margin, None, colours, grid)
        return replace(self, step_offsets=offsets), search

    def _grid_for(self, left: F32) -> TextureGrid:
        """The grid on which what seeds leave [C, H, W] costs less, by an estimate for the middle of it."""
        grids = self.tile.grids
        if len(grids) == 1:
            return grids[0]
        rows, columns = (_middle(side) for side in left.shape[1:])
        searches = (TextureSearch(left[:, rows, columns], self.tile.device, grid=grid) for grid in grids)
        lapped, separate = (search.estimate(self._steps(self.first_step), self.price, None) for search in searches)
        return grids[1] if separate < SEPARATE_COST * lapped else grids[0]

    @property
    def first_step(self) -> int:
        """Index of the lowest step of texture for λ."""
        return self.tile.tuning.step(self.tile.texture_lmbda)

    @property
    def price(self) -> float:
        """λ of texture in squared steps."""
        return self.tile.tuning.price(self.tile.texture_lmbda)

    def _steps(self, lowest: int) -> TextureIndices:
        return self.tile.tuning.steps(lowest, self.tile.spec.channels)

    def best_layer(
        self, search: TextureSearch, lowest: int, blocks: TextureSymbols | None = None
    ) -> TextureSymbols | None:
        """The layer of least cost, None where nothing is worth its bits. lowest: index of the lowest step; blocks: a
        layer whose blocks are taken, None for the best.
        """
        return search.at(self._steps(lowest), self.price, self.step_offsets, blocks)

    def best_strength(self, search: TextureSearch, layer: TextureSymbols | None) -> Strength | None:
        """With which to restore what this layer shows, None where that is better as it is."""
        if layer is None or not self.tile.spec.restoration:
            return None
        return self.tile.restorer.strength(search, layer, self.tile.texture_lmbda)


def _middle(side: int) -> slice:
    """The middle half of a side, all of a short one, from a multiple of 8 on, as grids of blocks begin."""
    size = max(side // 2, min(side, 256))
    start = (side - size) // 16 * 8
    return slice(start, start + size)
