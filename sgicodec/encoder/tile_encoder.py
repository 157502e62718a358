"""One picture, or one tile, on its way to a stream: fit, RDOQ, texture."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.candidate import Candidate, candidate_of
from sgicodec.encoder.coded_samples import coded_samples
from sgicodec.encoder.effort import effort_of
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.nodata import bare_samples
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.restoring import Restorer, Strength
from sgicodec.encoder.same_look import LookSteps
from sgicodec.encoder.score_ascent import Contrast, ScoreAscent
from sgicodec.encoder.settling import with_settled_seeds
from sgicodec.encoder.texture_contrast import TextureContrasts
from sgicodec.encoder.texture_handover import HANDOVER, LOOK_AHEAD, Handover
from sgicodec.encoder.texture_share import TextureCosts, seed_weights
from sgicodec.encoder.texture_tuning import TUNINGS, TextureTuning
from sgicodec.encoder.tile_stream import TileStream
from sgicodec.encoder.tile_time import TileTime
from sgicodec.fit.base_layer import base_layer
from sgicodec.metrics.choices import DISTORTIONS
from sgicodec.metrics.distortion import QuadraticReference, Reference, mean_weight
from sgicodec.model.layout import ROOT_LOG, SeedLayout, adaptive_layout, cell_sums, uniform_layout
from sgicodec.model.luma_space import to_luma_space
from sgicodec.model.texture_symbols import TextureSteps, TextureSymbols
from sgicodec.picture import Picture
from sgicodec.rate_control.lambda_controller import LambdaController
from sgicodec.rate_control.rd_model import RdModel
from sgicodec.rate_control.target import Measured
from sgicodec.rdoq import Objective, Rdoq, can_optimise
from sgicodec.rdoq.texture import TextureSearch, colours_for

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Fitted, Progress, Trainer

__all__ = ["Encoding", "make_ready"]


class Encoding:
    """The parts of an encode, for those who put them in order. `started`: a value of time.monotonic(); `ending` says
    whether the caller wants what is there; `stage` is called when a stage begins.

    `fit` holds the settings of the next fit; `begin` sets its λ, which the base layer follows. `stream` writes.
    `fitted_by`: the name of what made the last fit, empty before.
    """

    def __init__(self, picture: Picture, plan: Plan, started: float, device: Device = ALL_CORES) -> None:
        self.picture, self.plan, self.settings = picture, plan, plan.settings
        self.time = TileTime(plan.settings.time_limit, started, picture.width * picture.height)
        self.device = device
        self.ending: Callable[[], bool] = lambda: False
        self.stage: Callable[[str], None] = lambda _: None
        self.spec = plan.header.spec
        bare = bare_samples(picture, plan.header)
        self.unit, self.empty = coded_samples(picture, plan.header, bare)
        self.stream = TileStream(picture, plan, self.empty, bare, device)
        self._contrasts = TextureContrasts(self.tuning, self.unit)
        if self.spec.luma_space:
            self.unit = np.tensordot(to_luma_space(self.spec.channels).astype(np.float32), self.unit, axes=1)
        self.reference = DISTORTIONS[self.settings.minimised].reference(self.unit, self.empty)
        self.fit = self.settings.fit_settings()
        self.effort = effort_of(self.fit)
        self.fitted_by = ""
        self.strength: Strength | None = None  # of what restores pixels for the eye
        self.begin(self.fit.lmbda)

    def begin(self, lmbda: float) -> None:
        """Makes ready for a fit at λ."""
        self.lmbda = lmbda
        self.fit = replace(self.fit, lmbda=lmbda * (self.effort.seed_price if self.spec.texture else 1.0))
        for held in ("seed_reference", "_usual_contrast", "_contrast"):
            self.__dict__.pop(held, None)
        lmbda = self.fit.lmbda
        self.base_step, self.base, self.target = base_layer(self.spec, self.unit, lmbda, self.reference.weights)
        self.texture_costs = TextureCosts(self.target, self.lmbda, self.device)

    @cached_property
    def seed_reference(self) -> Reference:
        """What seeds are fitted to: the picture's distortion, less of it where texture follows for less bits."""
        if not (self.spec.texture and self.effort.scout and self.time.can_scout):
            return self.reference
        weights, family = self.reference.weights, self.plan.header.family
        share = seed_weights(self.spec, self.fit, self.texture_costs, family, self.effort.handover)
        if share is None:
            return self.reference
        return QuadraticReference(share if weights is None else share * weights)

    def run(self, on_progress: Callable[[Progress], bool] | None) -> Encoded:
        """Fits at a constant λ and writes."""
        if self.holds_nothing:
            return self.stream.nothing(self.lmbda)
        return self.encoded(self.textured(self.settled(self.searched(self.candidate(self.fitted(on_progress))))))

    @property
    def holds_nothing(self) -> bool:
        """Whether no pixel needs to be coded."""
        return self.empty is not None and bool(self.empty.all())

    def fitted(
        self,
        on_progress: Callable[[Progress], bool] | None,
        controller: LambdaController | None = None,
        share: float = 1.0,
    ) -> Fitted:
        """A fit, which `controller` may lead; of a time limit it takes about `share` less than is left."""
        from sgicodec.fit.trainer import Trainer

        self.stage("prepare")
        spec, fit, weights = self.spec, self.fit, self.seed_reference.weights
        _, height, width = self.target.shape
        if spec.layout == "uniform":
            count = fit.seeds or max(1, round(width * height / 400))
            layout = uniform_layout(width, height, count, np.random.default_rng(fit.seed))
        else:
            layout = self.first_layout()
        networks = load_prior(spec) if spec.context.prior else None
        trainer = Trainer(
            spec,
            fit,
            self.target,
            layout,
            self.plan.header.family,
            networks,
            controller=controller,
            seconds=self.time.of_fit(share, self.searches),
            device=self.device,
            weights=weights,
        )
        self.fitted_by = trainer.device_name
        self.stage("fit")
        return self._run(trainer, on_progress)

    def _run(self, trainer: Trainer, on_progress: Callable[[Progress], bool] | None) -> Fitted:
        """All phases of a fit, in the course of which seeds hand over to texture."""
        hands_over, ahead = self.spec.texture and self.effort.handover, None
        for progress in trainer.iterate():
            if on_progress is not None and not on_progress(progress):
                break
            done = trainer.schedule.done if hands_over else 0.0
            if done >= LOOK_AHEAD and ahead is None and self.time.can_scout:
                ahead = Handover(trainer, self.texture_costs).offsets_ahead()
            if done >= HANDOVER:
                hands_over = False
                if ahead is not None:
                    Handover(trainer, self.texture_costs, ahead).run()
                    if trainer.weights is not None:
                        self.__dict__["seed_reference"] = QuadraticReference(trainer.weights)
        return trainer.result()

    def first_layout(self) -> SeedLayout:
        """Where the seeds of a fit by the default profile begin."""
        return adaptive_layout(self.target, self.fit.split_price * self.fit.lmbda, weights=self.seed_reference.weights)

    def candidate(self, fitted: Fitted) -> Candidate:
        """A fit in integers."""
        return candidate_of(self.plan.header, fitted, self.base_step, self.base)

    @property
    def searches(self) -> bool:
        """Whether symbols are searched after the fit."""
        return self.settings.rdoq and can_optimise(self.spec)

    def rdoq(self, candidate: Candidate) -> Rdoq:
        """RDOQ from a candidate on."""
        self.stage("search")
        settings, reference = self.effort.rdoq, self.seed_reference
        return Rdoq(candidate.header, candidate.model, self.unit, candidate.lmbda, settings, self.device, reference)

    def searched(self, candidate: Candidate, least: int = 0) -> Candidate:
        """The best that the search finds for the candidate's λ, in at least this many passes."""
        if not self.searches:
            return candidate
        search, until = self.rdoq(candidate), self.time.search_end
        if search.settings.passes == 1 and not self.ending():
            return replace(candidate, model=search.once(candidate.lmbda))
        passes = max(search.settings.passes, least)
        found = search.at(candidate.lmbda, passes, until, lambda: search.passes >= least and self.ending())
        return replace(candidate, model=found.model)

    def settled(self, candidate: Candidate, step: int | None = None) -> Candidate:
        """The candidate with seeds that allow for the texture over them, in steps of this index, None for those of its
        λ. Where texture is to serve the eye, seeds stay: errors that are least to them are not to it.
        """
        rounds = self.effort.rounds
        if not (rounds and self.searches and self.spec.texture) or self.tuning.ascends:
            return candidate
        self.stage("texture")
        step, correction = self.tuning.step(self.lmbda) if step is None else step, None
        for _ in range(rounds):
            began = time.monotonic()
            search = self._texture_search(candidate)
            beside = search if correction is None else search.beside(correction)
            layer = self._layer(beside, step, None, None)
            if layer is None or self.ending():
                break
            shown = beside.exact(layer).draw(device=self.device)
            if strength := self._strength(search, layer):
                correction = self._restorer.correction(search, layer, strength)
                shown += correction
            left = self.unit - shown
            candidate = with_settled_seeds(candidate, left, self.lmbda, self.device, self.reference)
            if 2 * time.monotonic() - began > self.time.search_end:
                break
        return candidate

    def textured(self, candidate: Candidate) -> Candidate:
        """The candidate with texture over what its seeds leave, for the λ of the encode or the look of its plan."""
        if not self.spec.texture:
            return candidate
        search, price = self.texture_search(candidate), self.tuning.price(self.lmbda)
        cells, step = self.ascend(candidate, search, self.tuning.step(self.lmbda), price)
        return self.with_texture(candidate, search, step, price, cells)

    def ascend(
        self, candidate: Candidate, search: TextureSearch, step: int, price: float | None = None
    ) -> tuple[TextureSymbols | None, int]:
        """Makes layers better to the eye, where they are to serve it; the last of them, and the step of the next."""
        if not self.tuning.ascends:
            return None, step
        first = self._layer(search, step, price, None)
        self.strength = self._strength(search, first)
        passes = self.effort.ascent_passes
        ascent = ScoreAscent(self.unit, self.spec.luma_space, self.empty, self.device, self.strength)
        steps = LookSteps(self.plan.look, step, passes)

        def found(cells: TextureSymbols | None, score: float | None, contrast: Contrast) -> TextureSymbols | None:
            self._contrast = contrast
            return first if score is None else self._layer(search, steps.after(score), price, cells)

        def ending() -> bool:
            return self.ending() or time.monotonic() > self.time.search_end

        cells, score, self._contrast = ascent.run(search, found, self._usual_contrast, passes, ending)
        return cells, steps.after(score)

    def texture_search(self, candidate: Candidate) -> TextureSearch:
        """What finds texture over a candidate."""
        self.stage("texture")
        return self._texture_search(candidate)

    def _texture_search(self, candidate: Candidate) -> TextureSearch:
        objective = Objective(candidate.header, self.unit, self.device)
        left = objective.decoded_residual(candidate.model)[:, :, : self.unit.shape[2]]
        steps = self._steps(self.tuning.step(self.lmbda))
        colours = colours_for(left, steps, self.tuning.price(self.lmbda), self._contrast, self.device)
        return TextureSearch(left, self.device, self.effort.split_margin, colours=colours)

    @property
    def tuning(self) -> TextureTuning:
        """What texture is quantised for."""
        return TUNINGS[self.settings.tuned_for]

    def with_texture(
        self,
        candidate: Candidate,
        search: TextureSearch,
        step: int,
        price: float | None = None,
        cells: TextureSymbols | None = None,
    ) -> Candidate:
        """The candidate with texture in steps of this index. price: λ in squared steps, None for what suits them;
        cells: a layer whose cells are taken, None for the best.
        """
        found, strength = self._layer(search, step, price, cells), self.strength
        if found is not None and not self.tuning.ascends and (strength := self._strength(search, found)):
            beside = search.beside(self._restorer.correction(search, found, strength))
            found = self._layer(beside, step, price, found) or found  # for what the correction leaves
            strength = self._strength(search, found)
            if strength and self.effort.adapts_restoration:
                strength = self._restorer.adapted(search, found, strength, self.lmbda)
        restoration = strength.over(found) if found is not None and strength is not None else None
        return replace(candidate, model=replace(candidate.model, texture=found, restoration=restoration))

    def _layer(
        self, search: TextureSearch, step: int, price: float | None, cells: TextureSymbols | None
    ) -> TextureSymbols | None:
        price = self.tuning.squared_steps if price is None else price
        return search.at(self._steps(step), price, self._contrast, cells)

    def _steps(self, step: int) -> TextureSteps:
        """Steps of all channels, of which the lowest is of this index."""
        return self.tuning.steps(step, self.spec.channels)

    @cached_property
    def _usual_contrast(self) -> Contrast:
        """Of the tuning, for this λ."""
        return self._contrasts.at(self._steps(self.tuning.step(self.lmbda)))

    @cached_property
    def _contrast(self) -> Contrast:
        """Of the next layer: that of the tuning, until an ascent has a better one."""
        return self._usual_contrast

    @cached_property
    def _restorer(self) -> Restorer:
        return Restorer(self.unit, self.empty, self.tuning.network, self.device)

    def _strength(self, search: TextureSearch, layer: TextureSymbols | None) -> Strength | None:
        """Of what restores the pixels that this layer shows, None if they are better without."""
        if layer is None or not self.spec.restoration:
            return None
        return self._restorer.strength(search, layer, self.lmbda)

    def encoded(self, candidate: Candidate) -> Encoded:
        """The stream of a candidate."""
        return self.stream.encoded(candidate, self.lmbda)

    def measured(self, candidate: Candidate) -> tuple[Encoded, Measured]:
        """The stream of a candidate and what it is."""
        encoded = self.encoded(candidate)
        return encoded, self.stream.measured(encoded)

    def rd_model(self) -> RdModel:
        """The R-D model that predicts the outcome of fits."""
        sums, weight = cell_sums(self.target, ROOT_LOG), mean_weight(self.reference, self.target)
        return RdModel(sums, len(self.target), self.target[0].size, self.fit.split_price, weight)


def make_ready() -> None:
    """Loads what every fit needs, so that no tile's time pays for it."""
    import sgicodec.fit.trainer  # noqa: F401
