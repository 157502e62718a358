"""Passes against the real coder, and what they say of the squared error against dense sums in float64."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from reference_raster import rasterize_reference
from rough_models import stage
from scenes import ISAS

from sgicodec.bitstream.parts.tile import TileModel, quantise, write_tile
from sgicodec.model.gaussians import gaussians_from_seeds
from sgicodec.rdoq import Objective, RdoqSettings
from sgicodec.rdoq import coordinate_descent as descent
from sgicodec.rdoq.coordinate_descent import descend
from sgicodec.rdoq.objective import joined

PLAIN = RdoqSettings()


def dense_residual(objective: Objective, model: TileModel) -> NDArray[np.float64]:
    """Picture less drawn [C, H, W], every Gaussian everywhere; the base layer is zero."""
    _, height, width = objective.target.shape
    layout = model.layout
    centre, cell = layout.centre.astype(np.float64), layout.cell.astype(np.float64)
    gaussians = gaussians_from_seeds(objective.header.spec, joined(model), centre, cell, {}, np)
    return objective.target - rasterize_reference(*gaussians, width, height)


def passed(objective: Objective, model: TileModel, lmbda: float) -> tuple[TileModel, NDArray[np.float64]]:
    """A pass over what the model leaves."""
    return descend(objective, model, objective.residual(model), lmbda, PLAIN)


def coded(objective: Objective, model: TileModel) -> tuple[NDArray[np.float64], dict[str, float]]:
    """Attributes [N, d_A] as a stream would hold them, and the bits of its parts."""
    quantised = quantise(objective.header, model)
    _, bits = write_tile(objective.header, model)
    return quantised.decoded_values, bits


@pytest.mark.parametrize("isa", ISAS)
@pytest.mark.parametrize(
    ("channels", "width", "weighted"), [(1, 97, False), (3, 100, False), (4, 48, False), (1, 97, True), (3, 100, True)]
)
def test_promised_change_is_that_of_dense_sums(
    monkeypatch: pytest.MonkeyPatch, isa: str, channels: int, width: int, weighted: bool
) -> None:
    """A wide cutoff, so that what is left out is below rounding."""
    monkeypatch.setattr(descent, "DEFAULT_CUTOFF", 6.0)
    monkeypatch.setattr("sgicodec.raster.cpu.DEFAULT_CUTOFF", 6.0)
    objective, model = stage(channels, 61, width, isa, weighted=weighted)
    before = dense_residual(objective, model)
    padded = np.zeros((channels, 61, width + 16), np.float32)
    padded[:, :, :width] = before
    lmbda = 1e-4
    found, change = descend(objective, model, padded, lmbda, PLAIN)
    after = dense_residual(objective, found)
    bits = sum(coded(objective, found)[1][name] for name in ("colour", "shape", "offset"))
    weights = 1.0 if objective.weights is None else objective.weights
    expected = np.sum(weights * (after**2 - before**2)) + lmbda * bits
    assert expected < -1
    assert change.sum() == pytest.approx(expected, abs=2e-4 * np.sum(before**2))
    np.testing.assert_allclose(padded[:, :, :width], after, atol=2e-4)
    assert not padded[:, :, width:].any()


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_what_a_pass_finds_is_what_the_coder_codes(channels: int) -> None:
    objective, model = stage(channels)
    for _ in range(2):
        model, _ = passed(objective, model, 1e-3)
        np.testing.assert_array_equal(joined(model), coded(objective, model)[0])


def test_same_result_for_any_number_of_threads() -> None:
    found = [joined(passed(*stage(height=150, width=170, threads=threads), 1e-3)[0]) for threads in (1, 2, 3)]
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_seeds_outside_the_picture_do_no_harm() -> None:
    objective, model = stage()
    attributes = {name: values.copy() for name, values in model.attributes.items()}
    attributes["offset"][::3] = 300.0
    attributes["shape"][::5] = [8.0, 0.0, 0.0]
    attributes["shape"][1::5] = [-9.0, 3.0, 0.0]
    moved = replace(model, attributes=attributes)
    found, _ = passed(objective, moved, 1e-3)
    np.testing.assert_array_equal(joined(found), coded(objective, found)[0])
    (before, after) = (np.square(objective.decoded_residual(one)).sum() for one in (moved, found))
    (more, less) = (sum(coded(objective, one)[1].values()) for one in (moved, found))
    assert after + 1e-3 * less < before + 1e-3 * more
