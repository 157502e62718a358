"""Every distortion keeps the contract of `Distortion` and `Reference`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.choices import DISTORTIONS
from sgicodec.metrics.distortion import Distortion, QuadraticReference, Reference
from sgicodec.picture import to_unit


@pytest.mark.parametrize("name", DISTORTIONS)
def test_weights_are_those_of_the_value(name: str) -> None:
    """A single wrong pixel costs its weight for each channel; no error costs nothing."""
    rng = np.random.default_rng(0)
    reference = DISTORTIONS[name].reference(rng.uniform(0, 1, (3, 20, 30)).astype(np.float32))
    weights = np.ones((20, 30)) if reference.weights is None else reference.weights
    assert weights.shape == (20, 30)
    assert weights.min() > 0
    residual = np.zeros((3, 20, 30), np.float32)
    assert reference.value(residual) == 0
    residual[:, 7, 9] = 0.5
    assert reference.value(residual) == pytest.approx(0.75 * weights[7, 9])


class LeftCounts:
    """A distortion, added as CONTRIBUTING.md says: errors in the left half count nine times those in the right."""

    name = "left"

    def reference(self, picture: np.ndarray, empty: np.ndarray | None = None) -> Reference:
        weights = np.full(picture.shape[1:], 0.2, np.float32)
        weights[:, : picture.shape[2] // 2] = 1.8
        return QuadraticReference(weights)


def test_a_new_distortion_needs_no_other_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seeds go to where it counts, by its entry in `DISTORTIONS` alone."""
    whole = read(Path(__file__).parents[2] / "data" / "kodim13.png")
    picture = replace(whole, pixels=np.ascontiguousarray(whole.pixels[180:308, 100:228]))
    left: Distortion = LeftCounts()
    monkeypatch.setitem(DISTORTIONS, left.name, left)
    half, errors = picture.width // 2, {}
    for name in ("squared", left.name):
        data = encode_picture(picture, EncodeSettings(lmbda=0.004, steps=60, distortion=name, texture=False)).data
        squares = np.square(to_unit(open_stream(data).picture()) - to_unit(picture))
        errors[name] = squares[:, :half].sum(), squares[:, half:].sum()
    assert errors["left"][0] < 0.8 * errors["squared"][0]
    assert errors["left"][1] > 1.2 * errors["squared"][1]
