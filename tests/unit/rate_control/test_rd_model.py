"""R-D model of a picture and the λ to begin with, on noise whose strength changes over the picture."""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.model.layout import ROOT_LOG, cell_sums
from sgicodec.profiles.default import default_settings
from sgicodec.rate_control.rd_model import EMPTY_STREAM_BYTES, RdModel, initial_lmbda
from sgicodec.rate_control.target import RateTarget


def detail(seed: int = 0, height: int = 128, width: int = 192) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rough = rng.normal(size=(3, height, width)) * np.linspace(0, 0.2, width) ** 1.5
    return rough.astype(np.float32)


def model(picture: np.ndarray | None = None) -> RdModel:
    picture = detail() if picture is None else picture
    sums = cell_sums(picture, ROOT_LOG)
    return RdModel(sums, len(picture), picture[0].size, default_settings(0.01, 1000).split_price)


def test_dearer_seeds_are_fewer_and_leave_more() -> None:
    (count, deviation), (fewer, larger) = model().seeds(0.01), model().seeds(0.01, 4.0)
    assert 0 < fewer < count < 1
    assert 0 < deviation < larger
    assert model().seeds(0.04) == (fewer, larger)
    sizes, errors = zip(*(model().predict(lmbda) for lmbda in (0.001, 0.01, 0.1)), strict=True)
    assert sizes[0] > sizes[1] > sizes[2] > EMPTY_STREAM_BYTES
    assert all(1e-4 < error < 0.1 for error in errors)


def test_initial_lmbda_falls_with_size_and_psnr() -> None:
    sizes = [initial_lmbda(RateTarget(bytes=size), model()) for size in (500, 1000, 2000, 4000, 8000)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > 2 * sizes[-1]
    scores = [initial_lmbda(RateTarget(psnr=psnr), model()) for psnr in (20, 25, 30, 35)]
    assert scores == sorted(scores, reverse=True)
    assert scores[0] > 2 * scores[-1]


def test_initial_lmbda_knows_what_comes_on_top() -> None:
    plain, loaded = (initial_lmbda(RateTarget(bytes=4000), model(), extra) for extra in (0.0, 2000.0))
    assert loaded == pytest.approx(initial_lmbda(RateTarget(bytes=2000), model()), rel=0.2)
    assert loaded > plain


@pytest.mark.parametrize(
    "target", [RateTarget(bytes=1.0), RateTarget(bytes=1e9), RateTarget(psnr=5.0), RateTarget(psnr=150.0)]
)
@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 16, 16), (2, 70, 5)])
def test_initial_lmbda_of_flat_and_tiny_pictures(target: RateTarget, shape: tuple[int, int, int]) -> None:
    for picture in (np.zeros(shape, np.float32), detail()[: shape[0], : shape[1], : shape[2]]):
        assert 1e-6 <= initial_lmbda(target, model(picture)) <= 4.0
