"""Texture towards least squared error: searched, and again for what restoration leaves."""

from __future__ import annotations

from sgicodec.encoder.tile.state import TileState

__all__ = ["LeastSquares"]


class LeastSquares:
    """Texture of the least squared error for the bits."""

    def lay(self, state: TileState) -> TileState:
        """The tile with texture, restored, for the λ of the encode."""
        state, search = state.begin_texture()
        tile, tuning = state.tile, state.tile.tuning
        step, price = tuning.step(state.lmbda), tuning.price(state.lmbda)
        layer = state.best_layer(search, step, price)
        strength = state.best_strength(search, layer)
        if layer is None or strength is None:
            return state.with_texture(layer, None)
        restored = search.excluding(tile.restorer.correction(search, layer, strength))
        layer = state.best_layer(restored, step, price, layer) or layer
        return state.with_texture(layer, state.best_strength(search, layer))
