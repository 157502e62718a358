"""What a screen shows of a tile: colours over grey by their alpha, and gradients against finite differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sgicodec.encoder.tile.screen import Screen
from sgicodec.model.colours import to_channels
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec


def spec_of(channels: int, luma_space: bool) -> ModelSpec:
    return replace(default_spec(channels), luma_space=luma_space)


def samples_of(channels: int) -> np.ndarray:
    """Samples of which alpha, the last of them, is below 0, within 0..1 and above 1."""
    samples = np.random.default_rng(channels).uniform(0.1, 0.9, (channels, 4, 6))
    samples[-1, 0], samples[-1, 1] = -0.02, 1.05
    return samples


def planes(spec: ModelSpec) -> np.ndarray:
    """Their channels."""
    return np.tensordot(to_channels(spec), samples_of(spec.channels), axes=1).astype(np.float32)


@pytest.mark.parametrize(("channels", "luma_space"), [(2, False), (4, False), (4, True)])
def test_colours_lie_over_grey(channels: int, luma_space: bool) -> None:
    spec, plain = spec_of(channels, luma_space), samples_of(channels)
    shown = Screen(spec, has_alpha=True).shown(planes(spec))
    assert shown.shape == (channels - 1, 4, 6)
    np.testing.assert_allclose(shown[:, 0], 0.5, atol=1e-6)
    np.testing.assert_allclose(shown[:, 1], plain[:-1, 1], atol=1e-5)
    np.testing.assert_allclose(shown[:, 2:], 0.5 + (plain[:-1, 2:] - 0.5) * plain[-1:, 2:], atol=1e-5)


@pytest.mark.parametrize("has_alpha", [False, True])
@pytest.mark.parametrize(("channels", "luma_space"), [(2, False), (4, False), (4, True)])
def test_gradients_are_those_of_finite_differences(channels: int, luma_space: bool, has_alpha: bool) -> None:
    spec = spec_of(channels, luma_space)
    screen, given = Screen(spec, has_alpha), planes(spec)
    shown = screen.shown(given)
    slopes = np.random.default_rng(1).normal(size=shown.shape).astype(np.float32)
    found = screen.gradient(given, slopes)
    assert found.shape == given.shape
    for channel in range(channels):
        for place in ((0, 2), (1, 3), (2, 1), (3, 5)):
            ends = []
            for move in (-1e-2, 1e-2):
                moved = given.astype(np.float64)
                moved[channel, *place] += move
                ends.append(float((slopes * screen.shown(moved.astype(np.float32)).astype(np.float64)).sum()))
            expected = (ends[1] - ends[0]) / 2e-2
            assert found[channel, *place] == pytest.approx(expected, abs=2e-3)
