"""Texture over the seeds of a tile: what is the same for least squared error and for the eye."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from sgicodec.encoder.tile.restoration import Strength
from sgicodec.encoder.tile.state import Tile, TileState
from sgicodec.model.texture_symbols import TextureSteps, TextureSymbols
from sgicodec.rdoq import Objective
from sgicodec.rdoq.texture import TextureSearch, colours_for

__all__ = ["TextureStrategy", "begin_texture", "best_layer", "best_strength"]


class TextureStrategy(Protocol):
    """How texture is laid over seeds, towards one end."""

    def lay(self, state: TileState) -> TileState:
        """The tile with texture, restored, for the λ of the encode."""

    def aim(self, state: TileState, search: TextureSearch, step: int) -> tuple[TileState, TextureSearch]:
        """The tile and the search, both made better for texture whose lowest step has an index near this one."""

    def lay_at(self, state: TileState, search: TextureSearch, step: int, price: float | None = None) -> TileState:
        """The tile with texture whose lowest step has this index, restored. price: λ in squared steps, None for what
        suits them.
        """


def begin_texture(state: TileState) -> tuple[TileState, TextureSearch]:
    """The tile with the offsets of its λ, and what searches texture over its seeds as decoders have them."""
    tile = state.tile
    steps = _steps(tile, tile.tuning.step(state.lmbda))
    offsets = tile.masking.offsets(steps)
    left = Objective(state.header, tile.unit, tile.device).decoded_residual(state.model)[:, :, : tile.unit.shape[2]]
    colours = colours_for(left, steps, tile.tuning.price(state.lmbda), offsets, tile.device)
    search = TextureSearch(left, tile.device, tile.effort.split_margin, colours=colours)
    return replace(state, step_offsets=offsets), search


def best_layer(
    state: TileState,
    search: TextureSearch,
    step: int,
    price: float | None = None,
    blocks: TextureSymbols | None = None,
) -> TextureSymbols | None:
    """The layer of least cost, None where nothing is worth its bits. step, price: as in `TextureStrategy.lay_at`;
    blocks: a layer whose blocks are taken, None for the best.
    """
    price = state.tile.tuning.squared_steps if price is None else price
    return search.at(_steps(state.tile, step), price, state.step_offsets, blocks)


def best_strength(state: TileState, search: TextureSearch, layer: TextureSymbols | None) -> Strength | None:
    """With which to restore what this layer shows, None where that is better as it is."""
    if layer is None or not state.tile.spec.restoration:
        return None
    return state.tile.restorer.strength(search, layer, state.lmbda)


def _steps(tile: Tile, step: int) -> TextureSteps:
    """Steps of all channels, of which the lowest is of this index."""
    return tile.tuning.steps(step, tile.spec.channels)
