"""Ascents of a score: what its gradient moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import DATA
from numpy.typing import NDArray
from symbols import SymbolWriter, write_texture

from sgicodec import read
from sgicodec.device import ONE_THREAD
from sgicodec.encoder.tile.perceptual import ScoreAscent, mean_moves
from sgicodec.encoder.tile.screen import Screen
from sgicodec.encoder.tile.texture_steps import TUNINGS, Masking
from sgicodec.metrics.psnr import luma
from sgicodec.metrics.scores import scores
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.colours import to_channels, to_samples
from sgicodec.model.texture_symbols import TextureSymbols
from sgicodec.profiles.default import default_spec
from sgicodec.rdoq.texture import TextureSearch

TUNING = TUNINGS["visual"]
STEP = 405


class Case:
    """384×256 pixels of a photograph, texture over their means."""

    def __init__(self, luma_space: bool = False, empty: np.ndarray | None = None, step: int = STEP) -> None:
        self.step = step
        pixels = read(DATA / "kodim13.png").pixels[230:486, 100:484].astype(np.float32) / 255
        self.seen = np.ascontiguousarray(pixels.transpose(2, 0, 1))
        self.spec = replace(default_spec(3), luma_space=luma_space)
        self.unit = np.tensordot(to_channels(self.spec).astype(np.float32), self.seen, axes=1)
        self.base = np.broadcast_to(self.unit.mean(axis=(1, 2), keepdims=True), self.unit.shape)
        self.offsets = Masking(TUNING, luma(pixels, peak=1.0)).offsets(TUNING.steps(step, 3))
        self.search = TextureSearch(self.unit - self.base, ONE_THREAD)
        self.empty = empty
        self.blocks: TextureSymbols | None = None  # of the last layer

    def found(self, blocks: TextureSymbols | None = None) -> TextureSymbols:
        layer = self.search.at(TUNING.steps(self.step, 3), TUNING.squared_steps, self.offsets, blocks)
        assert layer is not None
        return layer

    def rounded(self, blocks: TextureSymbols) -> NDArray[np.int16]:
        """The symbols of these blocks that are nearest to what is looked for, whatever they cost."""
        layer = self.search.at(TUNING.steps(self.step, 3), 0.0, self.offsets, blocks)
        return layer.symbols

    def ascend(self, passes: int) -> list[float]:
        """Returns the scores of the layers."""
        ascent = ScoreAscent(self.unit, Screen(self.spec), self.empty, ONE_THREAD)
        layer, gradient, scores = None, None, []
        for mean in mean_moves(passes):
            layer = self.found(layer)
            score, gradient = ascent.climb(self.search, layer, self.offsets, mean, gradient)
            scores.append(score)
        self.blocks = layer
        return scores

    def decoded(self) -> NDArray[np.float32]:
        shown = self.base + self.found(self.blocks).draw()
        seen: NDArray[np.float32] = np.tensordot(to_samples(self.spec), shown, axes=1).astype(np.float32)
        return seen

    def score(self) -> float:
        return VisualReference(self.seen, ONE_THREAD).score(self.decoded())

    def similarity(self) -> float:
        """MS-SSIM."""
        pictures = ((255 * np.clip(planes, 0, 1)).round().astype(np.uint8) for planes in (self.seen, self.decoded()))
        return scores(*(np.ascontiguousarray(picture.transpose(1, 2, 0)) for picture in pictures)).ms_ssim

    def bits(self) -> float:
        writer = SymbolWriter()
        write_texture(writer, self.search.size, 3, self.found(self.blocks))
        return writer.bits


@pytest.mark.parametrize("luma_space", [False, True])
@pytest.mark.parametrize(("passes", "finer", "points"), [(1, 2, 2.5), (4, 3, 2.5)])
def test_a_layer_scores_more_than_one_of_finer_steps(luma_space: bool, passes: int, finer: int, points: float) -> None:
    case, other = Case(luma_space), Case(luma_space, step=STEP - finer)
    case.ascend(passes)
    assert case.bits() < other.bits() < 1.1 * case.bits()
    assert case.score() > other.score() + points
    assert case.similarity() > other.similarity() - 0.002  # which is not climbed


def test_pixels_that_count_nothing_move_nothing() -> None:
    case = Case(empty=np.ones((256, 384), bool))
    before = case.found()
    assert case.ascend(2) == [pytest.approx(100)] * 2
    assert np.array_equal(case.found().symbols, before.symbols)

    half = np.zeros((256, 384), bool)
    half[:, 192:] = True
    case = Case(empty=half)
    blocks = case.found()
    before = case.rounded(blocks)
    case.ascend(3)
    moved = (case.rounded(blocks) != before).any(axis=0)
    assert moved[:, :192].mean() > 0.02
    assert not moved[:, 224:].any()


@pytest.mark.parametrize("luma_space", [False, True])
def test_scores_are_those_of_what_is_decoded(luma_space: bool) -> None:
    case = Case(luma_space)
    first = case.score()
    assert case.ascend(1) == [pytest.approx(first, abs=0.05)]


@pytest.mark.parametrize("channels", [1, 2, 4])
def test_other_channels_than_three(channels: int) -> None:
    seen = Case().seen
    unit, spec = np.ascontiguousarray(np.concatenate([seen, seen[:1]])[:channels]), default_spec(channels)
    into, back = (matrix(spec).astype(np.float32) for matrix in (to_channels, to_samples))
    search = TextureSearch(np.tensordot(into, unit - 0.5, axes=1), ONE_THREAD)
    steps = TUNING.steps(STEP, channels)

    def score() -> float:
        layer = search.at(steps, TUNING.squared_steps)
        return VisualReference(unit, ONE_THREAD).score(0.5 + np.tensordot(back, layer.draw(), axes=1))

    before = score()
    ascent, layer = ScoreAscent(np.tensordot(into, unit, axes=1), Screen(spec), None, ONE_THREAD), None
    for mean in mean_moves(2):
        layer = search.at(steps, TUNING.squared_steps, None, layer)
        assert layer is not None
        ascent.climb(search, layer, None, mean)
    assert score() > before + 1
