"""Ascents of scores: what gradients move, and how steps move between superblocks."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import DATA
from numpy.typing import NDArray

from sgicodec import read
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.parts.texture import write_texture
from sgicodec.device import ONE_THREAD
from sgicodec.encoder.tile.perceptual import ScoreAscent, better_offsets
from sgicodec.encoder.tile.texture_steps import TUNINGS, Masking
from sgicodec.metrics.scores import scores
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.luma_space import from_luma_space, to_luma_space
from sgicodec.model.texture_symbols import CONTRAST_LIMIT, TextureSteps, TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

TUNING = TUNINGS["visual"]
STEP = 405


class Case:
    """384×256 pixels of a photograph, texture over their means."""

    def __init__(self, luma_space: bool = False, empty: np.ndarray | None = None, step: int = STEP) -> None:
        self.step = step
        pixels = read(DATA / "kodim13.png").pixels[230:486, 100:484].astype(np.float32) / 255
        self.seen = np.ascontiguousarray(pixels.transpose(2, 0, 1))
        into = to_luma_space(3).astype(np.float32) if luma_space else np.eye(3, dtype=np.float32)
        self.unit = np.ascontiguousarray(np.tensordot(into, self.seen, axes=1))
        self.base = np.broadcast_to(self.unit.mean(axis=(1, 2), keepdims=True), self.unit.shape)
        self.back = from_luma_space(3) if luma_space else np.eye(3)
        self.offsets = Masking(TUNING, self.seen).offsets(TUNING.steps(step, 3))
        self.search = TextureSearch(self.unit - self.base, ONE_THREAD)
        self.luma_space, self.empty = luma_space, empty

    def found(self, blocks: TextureSymbols | None = None) -> TextureSymbols:
        layer = self.search.at(TUNING.steps(self.step, 3), TUNING.squared_steps, self.offsets, blocks)
        assert layer is not None
        return layer

    def ascend(self, passes: int) -> list[float]:
        """Returns the scores of the layers."""
        ascent = ScoreAscent(self.unit, self.luma_space, self.empty, ONE_THREAD, passes)
        usual, layer, scores = self.offsets, None, []
        for _ in range(passes):
            layer = self.found(layer)
            score, self.offsets = ascent.climb(self.search, layer, self.offsets, usual)
            scores.append(score)
        return scores

    def decoded(self) -> NDArray[np.float32]:
        seen: NDArray[np.float32] = np.tensordot(self.back, self.base + self.found().layer().draw(), axes=1)
        return seen.astype(np.float32)

    def score(self) -> float:
        return VisualReference(self.seen, ONE_THREAD).score(self.decoded())

    def similarity(self) -> float:
        """MS-SSIM."""
        pictures = ((255 * np.clip(planes, 0, 1)).round().astype(np.uint8) for planes in (self.seen, self.decoded()))
        return scores(*(np.ascontiguousarray(picture.transpose(1, 2, 0)) for picture in pictures)).ms_ssim

    def bits(self) -> float:
        writer = SymbolWriter()
        with writer.part("texture"):
            write_texture(writer, self.search.size, 3, self.found())
        return writer.bits["texture"]


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
    before = case.found()
    case.ascend(3)
    moved = (case.found().symbols != before.symbols).any(axis=0)
    # models adapt, so that a few symbols change elsewhere too
    assert moved[:, :192].mean() > 3 * moved[:, 224:].mean()


@pytest.mark.parametrize("luma_space", [False, True])
def test_scores_are_those_of_what_is_decoded(luma_space: bool) -> None:
    case = Case(luma_space)
    first = case.score()
    assert case.ascend(1) == [pytest.approx(first, abs=0.05)]


@pytest.mark.parametrize("channels", [1, 2, 4])
def test_other_channels_than_three(channels: int) -> None:
    seen = Case().seen
    unit = np.ascontiguousarray(np.concatenate([seen, seen[:1]])[:channels])
    search = TextureSearch(unit - 0.5, ONE_THREAD)
    steps = TUNING.steps(STEP, channels)

    def score() -> float:
        layer = search.at(steps, TUNING.squared_steps)
        assert layer is not None
        return VisualReference(unit, ONE_THREAD).score(0.5 + layer.layer().draw())

    before = score()
    ascent, layer = ScoreAscent(unit, False, None, ONE_THREAD, passes=2), None
    for _ in range(2):
        layer = search.at(steps, TUNING.squared_steps, None, layer)
        assert layer is not None
        ascent.climb(search, layer, None, None)
    assert score() > before + 1


ROWS, COLUMNS = 6, 8
USUAL = np.zeros((ROWS, COLUMNS), np.int8)


def symbols_of(count: NDArray[np.int64]) -> TextureSymbols:
    """A layer with so many symbols that are not 0 in each superblock, a third of them of each channel."""
    symbols = np.zeros((3, 32 * ROWS, 32 * COLUMNS), np.int16)
    for (row, column), number in np.ndenumerate(count):
        superblock = np.zeros(3 * 32 * 32, np.int16)
        superblock[:number] = np.where(np.arange(number) % 2, -3, 1)
        at = slice(32 * row, 32 * row + 32), slice(32 * column, 32 * column + 32)
        symbols[:, at[0], at[1]] = superblock.reshape(32, 32, 3).transpose(2, 0, 1)
    log_size = np.full((4 * ROWS, 4 * COLUMNS), 5, np.uint8)
    return TextureSymbols((32 * COLUMNS, 32 * ROWS), TextureSteps(400), log_size, USUAL, symbols)


def pixels_of(loss: NDArray[np.float64], height: int = 32 * ROWS, width: int = 32 * COLUMNS) -> NDArray[np.float32]:
    """Gains of pixels that add up to so much in each superblock."""
    pixels = np.repeat(np.repeat(loss / 1024, 32, axis=0), 32, axis=1)
    return pixels[:height, :width].astype(np.float32)


def test_where_errors_cost_more_for_each_symbol_steps_become_finer() -> None:
    loss = np.full((ROWS, COLUMNS), 1.0)
    loss[:, :4] = 16.0
    found = better_offsets(USUAL, USUAL, pixels_of(loss), symbols_of(np.full((ROWS, COLUMNS), 300)))
    # steps are two octaves apart from equal losses, one on each side; a quarter of it is a quarter of an octave
    assert (found[:, :3] == -1).all()
    assert (found[:, 5:] == 1).all()


def test_equal_losses_for_symbols_leave_contrasts_as_they_are() -> None:
    count = np.random.default_rng(1).integers(200, 210, (ROWS, COLUMNS))
    offsets = np.random.default_rng(2).integers(-3, 4, (ROWS, COLUMNS)).astype(np.int8)
    found = better_offsets(offsets, offsets, pixels_of((count + 40) * 0.01), symbols_of(count))
    np.testing.assert_array_equal(found, offsets)


def test_roots_of_few_symbols_tell_nothing_and_stay() -> None:
    count = np.full((ROWS, COLUMNS), 400)
    count[:, 4:] = 20
    loss = np.random.default_rng(3).uniform(0.1, 40, (ROWS, COLUMNS))
    found = better_offsets(USUAL, USUAL, pixels_of(loss), symbols_of(count))
    assert found[:, :3].any()
    assert not found[:, 5:].any()

    nothing = np.zeros((ROWS, COLUMNS), np.int64)
    np.testing.assert_array_equal(better_offsets(USUAL, USUAL, pixels_of(loss), symbols_of(nothing)), USUAL)


@pytest.mark.parametrize("level", [-CONTRAST_LIMIT, 0, CONTRAST_LIMIT])
def test_contrasts_stay_near_those_of_the_tuning_and_within_the_format(level: int) -> None:
    loss = np.full((ROWS, COLUMNS), 1e-3)
    loss[:, :4] = 1e3
    offsets = usual = np.full((ROWS, COLUMNS), level, np.int8)
    for _ in range(20):
        offsets = better_offsets(offsets, usual, pixels_of(loss), symbols_of(np.full((ROWS, COLUMNS), 300)))
    assert offsets.dtype == np.int8
    assert offsets[0, 0] == max(level - 4, -CONTRAST_LIMIT)
    assert level < offsets[0, 7] <= level + 4 or offsets[0, 7] == CONTRAST_LIMIT


def test_scores_that_fall_without_errors_say_nothing() -> None:
    count = symbols_of(np.full((ROWS, COLUMNS), 300))
    for loss in (np.zeros((ROWS, COLUMNS)), np.full((ROWS, COLUMNS), -1.0)):
        np.testing.assert_array_equal(better_offsets(USUAL, USUAL, pixels_of(loss), count), USUAL)


def test_roots_reach_beyond_the_picture() -> None:
    loss = np.full((ROWS, COLUMNS), 5.0)
    gain = pixels_of(loss, 32 * ROWS - 11, 32 * COLUMNS - 30)
    found = better_offsets(USUAL, USUAL, gain, symbols_of(np.full((ROWS, COLUMNS), 300)))
    # of the last column two pixels in 32 are there, and lose as little; of the last row 21
    assert (found[:, -1] > found[:, 0]).all()
    assert not found[:-1, :-2].any()
