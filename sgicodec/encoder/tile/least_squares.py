"""Texture towards least squared error: seeds and texture are searched in turn, each for what the other leaves.

A fit does not see the texture that will lie over its seeds: it counts errors less where texture follows. Once texture
is there, what it leaves is known, and the symbols of seeds are searched again for that; then texture over them. What
texture rounds is left out, for it will be rounded anew. Texture itself is searched again for what restoration leaves.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.encoder.tile.state import TileState
from sgicodec.rdoq import Objective, RdoqSettings, searched
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["LeastSquares", "requantise_seeds_under_texture"]

DEARER = 1.4
"""λ of seeds that are searched again, in the λ of the encode: 1.4 and 1.8 take 0.1 % fewer bytes than 1
(docs/notes/2026-11-settling.md)."""
SETTINGS = RdoqSettings(passes=1, deep=7, rounds=4, coarser=0.0)
"""Other steps would move all values of seeds, which costs more than it gains. Seven choices of colours and four rounds
take 0.1 % fewer bytes than three of each (docs/notes/2026-11-settling.md)."""


class LeastSquares:
    """Texture of the least squared error for the bits."""

    def lay(self, state: TileState) -> TileState:
        """The tile with texture, restored, for the λ of the encode."""
        state, search = state.begin_texture()
        tuning = state.tile.tuning
        return self.lay_at(state, search, tuning.step(state.lmbda), tuning.price(state.lmbda))

    def aim(self, state: TileState, search: TextureSearch, step: int) -> tuple[TileState, TextureSearch]:
        """The tile and the search for texture whose lowest step has an index near this one: with seeds for that."""
        return requantise_seeds_under_texture(state, step).begin_texture()

    def lay_at(self, state: TileState, search: TextureSearch, step: int, price: float | None = None) -> TileState:
        """The tile with texture whose lowest step has this index, restored. price: as in `TileState.best_layer`."""
        tile, layer = state.tile, state.best_layer(search, step, price)
        strength = state.best_strength(search, layer)
        if layer is None or strength is None:
            return state.with_texture(layer, None)
        restored = search.excluding(tile.restorer.correction(search, layer, strength))
        layer = state.best_layer(restored, step, price, layer) or layer
        return state.with_texture(layer, state.best_strength(search, layer))


def requantise_seeds_under_texture(state: TileState, step: int | None = None) -> TileState:
    """The tile with seeds that allow for the texture over them, in as many rounds as its effort has. step: index of
    texture's lowest step, None for that of λ.
    """
    tile, correction = state.tile, None
    if not (tile.effort.rounds and tile.has_rdoq and tile.spec.texture):
        return state
    tile.watch.stage("texture")
    step = tile.tuning.step(state.lmbda) if step is None else step
    for _ in range(tile.effort.rounds):
        state, search = state.begin_texture()
        restored = search if correction is None else search.excluding(correction)
        layer = state.best_layer(restored, step)
        if layer is None or tile.watch.ending():
            break
        shown = restored.exact(layer).draw(device=tile.device)
        if strength := state.best_strength(search, layer):
            correction = tile.restorer.correction(search, layer, strength)
            shown += correction
        state = with_seeds_for(state, tile.unit - shown)
    return state


def with_seeds_for(state: TileState, left: NDArray[np.float32]) -> TileState:
    """The tile with its seeds' symbols searched once more for what is left to them [C, H, W]: the picture less all that
    is shown over them.
    """
    objective = Objective(state.header, left, state.tile.device)
    return replace(state, model=searched(objective, state.model, DEARER * state.lmbda, SETTINGS))
