"""A tile without texture on its way to a rate target: λ moves in the course of the fit and between passes of RDOQ."""

from __future__ import annotations

from dataclasses import replace

from sgicodec.encoder.tile.stages import fit, prepare, rd_model, rdoq_search, share
from sgicodec.encoder.tile.state import Prepared, Tile, TileState
from sgicodec.encoder.tile.writing import WrittenTile, measured, write
from sgicodec.metrics.distortion import decibels
from sgicodec.model.network import DIFFERENCE_SHIFT
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.rd_model import initial_lmbda
from sgicodec.rate_control.rdoq_controller import MAX_EXTRA_PASSES, RdoqController, StreamEstimate, fit_target
from sgicodec.rate_control.side_information import side_bytes
from sgicodec.rate_control.step_search import step_shift
from sgicodec.rate_control.target import Measured, RateTarget
from sgicodec.rdoq.adaptation import with_coarser_steps

__all__ = ["best_by_seeds"]

REFIT_MAX_ERROR = 1.0
"""Rate error, octaves of λ, up to which a missed PSNR is worth a second fit."""

Stream = tuple[WrittenTile, Measured]


def best_by_seeds(tile: Tile, target: RateTarget, extra: float) -> Stream:
    """One fit, or two towards a PSNR that the first missed by little. extra: bytes beside seeds and base layer. What
    still misses the target has all its steps shifted.
    """
    fitted_target = fit_target(target) if tile.has_rdoq else target
    first = fitted_target if target.psnr is None else target

    def stream_at(lmbda: float, jumps: bool = True) -> Stream:
        prepared = prepare(tile, lmbda)
        controller = LambdaController(fitted_target, lmbda, _overhead(prepared, extra), jumps)
        return _at_target(fit(share(prepared), controller), target)

    lmbda = initial_lmbda(first, rd_model(prepare(tile, tile.fit.lmbda)), extra)
    found = stream_at(lmbda)
    is_near = target.psnr is not None and target.rate_error(found[1]) > -REFIT_MAX_ERROR
    if target.is_missed(found[1]) and is_near and not tile.watch.was_ended:
        # Seeds were dropped that were needed: once more, from a smaller λ.
        return max(found, stream_at(0.5 * lmbda, jumps=False), key=lambda one: one[1].psnr)
    return found


def _overhead(prepared: Prepared, extra: float) -> float:
    """Bytes of the stream beside its seeds."""
    return side_bytes(prepared.target.size / max(1, prepared.tile.spec.base_cell**2), extra)


def _at_target(state: TileState, target: RateTarget) -> Stream:
    if state.tile.has_rdoq:
        state, found = _optimised(state, target)
        if target.is_met(found[1]):
            return found
    tried: dict[float, Stream] = {}

    def measure(shift: float) -> Measured:
        tried[shift] = _measured(_shifted(state, shift), target)
        return tried[shift][1]

    return tried[step_shift(target, measure)]


def _optimised(start: TileState, target: RateTarget) -> tuple[TileState, Stream]:
    """RDOQ in at least as many passes as without a target; the last one that met it, else the nearest."""
    tile, search = start.tile, rdoq_search(start)
    controller, estimate = RdoqController(target, start.seed_lmbda), StreamEstimate()
    tries: list[tuple[TileState, Measured]] = []
    for number in range(search.settings.passes + MAX_EXTRA_PASSES):
        may_end = number >= search.settings.passes - 1
        found = search.descend(controller.lmbda)
        state = replace(start, model=found.model, seed_lmbda=controller.lmbda)
        bits, psnr = found.cost.bits, decibels(found.cost.squared_error, tile.unit.size)
        guess = estimate.of(bits, psnr)
        if number == 0 or (may_end and target.is_met(guess)):
            written, guess = _measured(state, target)
            estimate.correct(bits, psnr, guess)
            if may_end and target.is_met(guess):
                return state, (written, guess)
        tries.append((state, guess))
        if tile.watch.ending():
            break
        controller.update(guess)
    met = [state for state, guess in tries if target.is_met(guess)]
    state = met[-1] if met else tries[target.nearest([guess for _, guess in tries])][0]
    return state, _measured(state, target)


def _measured(state: TileState, target: RateTarget) -> Stream:
    written = write(state)
    return written, measured(written, state.tile, target)


def _shifted(state: TileState, shift: float) -> TileState:
    """The tile with all steps of its attributes coarser by `shift` units."""
    networks = with_coarser_steps(state.model.networks, shift / 2**DIFFERENCE_SHIFT)
    return replace(state, model=replace(state.model, networks=networks))
