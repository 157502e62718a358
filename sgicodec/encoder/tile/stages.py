"""The stages of a tile, in their order: from pixels to a model, which `writing` makes a stream of.

prepare      samples, the base layer, and what it leaves to seeds and texture
share        detail without a direction is left to texture
fit          seeds by gradient descent
rdoq         symbols of least error plus λ times bits
texture      cosines for what seeds leave, and restoration of what both show
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sgicodec.bitstream.parts.prior import load_prior, parse_prior
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.encoder.effort import DEFAULT_EFFORT, steps_of
from sgicodec.encoder.tile.perceptual import best_looking
from sgicodec.encoder.tile.sharing import part_of_steps, seed_weights
from sgicodec.encoder.tile.state import Prepared, Tile, TileState
from sgicodec.fit.base_layer import base_layer
from sgicodec.fit.trainer import Fitted, Trainer
from sgicodec.model.layout import SeedLayout, adaptive_layout, uniform_layout
from sgicodec.model.network import IntNetwork
from sgicodec.rdoq import Objective, searched


def encode(tile: Tile) -> TileState:
    """The tile through all stages, at a constant λ."""
    return texture(fit_seeds(tile))


def fit_seeds(tile: Tile) -> TileState:
    """The tile through the stages before texture."""
    prepared = prepare(tile)
    prepared = share(prepared)
    state = fit(prepared)
    return rdoq(state)


def prepare(tile: Tile) -> Prepared:
    """The tile with its base layer taken off."""
    fit = tile.fit
    if tile.spec.texture:
        fit = replace(fit, lmbda=tile.effort.seed_lmbda(fit.lmbda))
    base_step, base, target = base_layer(tile.spec, tile.unit, fit.lmbda)
    return Prepared(tile, fit, base_step, base, target, tile.weights)


def share(prepared: Prepared) -> Prepared:
    """Lets seeds count less where texture follows for fewer bits."""
    tile = prepared.tile
    if not tile.spec.texture:
        return prepared
    part = seed_weights(prepared.target, tile.fit.lmbda)
    return replace(prepared, weights=part if tile.weights is None else part * tile.weights)


def fit(prepared: Prepared) -> TileState:
    """Fits seeds, in fewer steps where texture will show nearly all and no number of steps was stated."""
    tile, fit_settings, layout = prepared.tile, prepared.fit, _first_layout(prepared)
    if tile.spec.texture and tile.settings.steps is None and prepared.weights is not None:
        usual = steps_of(DEFAULT_EFFORT, tile.settings.tuned_for, True)
        part = part_of_steps(fit_settings.steps, usual, layout, prepared.weights)
        fit_settings = fit_settings.shortened(part)
    trainer = Trainer(
        tile.spec,
        fit_settings,
        prepared.target,
        layout,
        _networks(tile),
        device=tile.device,
        weights=prepared.weights,
    )
    tile.watch.fitted_by = trainer.device_name
    tile.watch.stage("fit")
    for progress in trainer.iterate():
        if not tile.watch.step(progress):
            break
    return in_integers(prepared, trainer.result())


def _networks(tile: Tile) -> tuple[IntNetwork, ...] | None:
    """The context model of the tile, None where the fit trains one."""
    if tile.settings.prior is not None:
        return parse_prior(tile.settings.prior, tile.spec)
    return load_prior(tile.spec) if tile.spec.context.prior else None


def _first_layout(prepared: Prepared) -> SeedLayout:
    """Where the seeds of a fit begin."""
    fit, (_, height, width) = prepared.fit, prepared.target.shape
    if prepared.tile.spec.layout == "uniform":
        count = fit.seeds or max(1, round(width * height / 400))
        return uniform_layout(width, height, count, np.random.default_rng(fit.seed))
    price = fit.split * fit.seed_bits * fit.lmbda
    return adaptive_layout(prepared.target, price, weights=prepared.weights)


def in_integers(prepared: Prepared, fitted: Fitted) -> TileState:
    """A fit in integers."""
    model = TileModel(
        fitted.layout,
        fitted.plan,
        prepared.base_step,
        prepared.base,
        {name: np.rint(w * 2.0**fitted.decoder_shift).astype(np.int64) for name, w in fitted.decoders.items()},
        fitted.networks,
        fitted.hash_bits,
        fitted.attributes,
        decoder_shift=fitted.decoder_shift,
    )
    header = replace(prepared.tile.header, colour_step=fitted.colour_step)
    return TileState(**vars(prepared), header=header, model=model)


def rdoq(state: TileState) -> TileState:
    """The tile with the best symbols that RDOQ finds for the λ of its seeds."""
    tile = state.tile
    if not tile.has_rdoq:
        return state
    tile.watch.stage("search")
    objective = Objective(state.header, state.target, tile.device, state.weights)
    model = searched(objective, state.model, state.fit.lmbda, tile.effort.rdoq, tile.watch.ending)
    return replace(state, model=model)


def texture(state: TileState) -> TileState:
    """The tile with texture over what its seeds leave, restored, for its λ."""
    tile = state.tile
    if not tile.spec.texture:
        return state
    tile.watch.stage("texture")
    return best_looking(state) if tile.settings.tuned_for == "visual" else _nearest(state)


def _nearest(state: TileState) -> TileState:
    """With texture of the least squared error for the bits: searched, and again for what restoration leaves."""
    state, search = state.begin_texture()
    layer = state.best_layer(search, state.first_step)
    strength = state.best_strength(search, layer)
    if layer is None or strength is None:
        return state.with_texture(layer, None)
    restored = search.excluding(state.tile.restorer.correction(search, layer, strength))
    layer = state.best_layer(restored, state.first_step, layer) or layer
    return state.with_texture(layer, state.best_strength(search, layer))
