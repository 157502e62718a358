"""Texture towards least squared error: searched, and again for what restoration leaves."""

from __future__ import annotations

from sgicodec.encoder.tile.state import TileState
from sgicodec.rdoq.texture import TextureSearch

__all__ = ["LeastSquares"]


class LeastSquares:
    """Texture of the least squared error for the bits."""

    def lay(self, state: TileState) -> TileState:
        """The tile with texture, restored, for the λ of the encode."""
        state, search = state.begin_texture()
        tuning = state.tile.tuning
        return self.lay_at(state, search, tuning.step(state.lmbda), tuning.price(state.lmbda))

    def aim(self, state: TileState, search: TextureSearch, step: int) -> tuple[TileState, TextureSearch]:
        """The tile and the search for texture whose lowest step has an index near this one."""
        return state, search

    def lay_at(self, state: TileState, search: TextureSearch, step: int, price: float | None = None) -> TileState:
        """The tile with texture whose lowest step has this index, restored. price: as in `TileState.best_layer`."""
        tile, layer = state.tile, state.best_layer(search, step, price)
        strength = state.best_strength(search, layer)
        if layer is None or strength is None:
            return state.with_texture(layer, None)
        restored = search.excluding(tile.restorer.correction(search, layer, strength))
        layer = state.best_layer(restored, step, price, layer) or layer
        return state.with_texture(layer, state.best_strength(search, layer))
