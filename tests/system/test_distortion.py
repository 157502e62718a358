"""What an encode minimises: each distortion in streams of a real picture, as files would show it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.cli.encode import encode as command
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import UsageError
from sgicodec.metrics.choices import DISTORTIONS
from sgicodec.metrics.distortion import squared_error
from sgicodec.picture import to_unit

DATA = Path(__file__).parents[1] / "data"
LMBDA = 0.004


@pytest.fixture(scope="module")
def picture() -> Picture:
    """Busy rocks below a flat sky."""
    whole = read(DATA / "kodim13.png")
    return replace(whole, pixels=np.ascontiguousarray(whole.pixels[20:212, 100:356]))


def test_each_distortion_costs_least_where_it_is_minimised(picture: Picture) -> None:
    """J = D + λR, with D of the decoded picture and R of the stream. Of seeds alone: texture has its own tuning."""
    unit = np.ascontiguousarray(to_unit(picture).transpose(2, 0, 1))
    weights = {name: distortion.reference(unit).weights for name, distortion in DISTORTIONS.items()}
    costs: dict[str, dict[str, float]] = {}
    for made_for in DISTORTIONS:
        data = encode_picture(picture, EncodeSettings(lmbda=LMBDA, steps=300, distortion=made_for, texture=False)).data
        decoded = open_stream(data).picture()
        costs[made_for] = {
            name: squared_error(picture, decoded, weights[name]) + LMBDA * 8 * len(data) for name in DISTORTIONS
        }
    for name in DISTORTIONS:
        others = [cost[name] for made_for, cost in costs.items() if made_for != name]
        assert costs[name][name] < min(others)


def test_tiles_are_fitted_to_the_same_distortion(picture: Picture) -> None:
    settings = EncodeSettings(lmbda=LMBDA, steps=60, tile=128, texture=False)
    plain, weighted = (encode_picture(picture, replace(settings, distortion=name)) for name in ("squared", "weighted"))
    assert len(weighted.data) < len(plain.data)  # rocks count less
    assert open_stream(weighted.data).header.grid.count == 4


def test_a_psnr_is_met_whatever_is_minimised(picture: Picture) -> None:
    encoded = encode_picture(picture, EncodeSettings(psnr=27.0, steps=150, distortion="weighted"))
    decoded = open_stream(encoded.data).picture()
    error = squared_error(picture, decoded) / picture.pixels.size
    assert -10 * np.log10(error) == pytest.approx(27.0, abs=0.1)


def test_settings_that_make_no_sense() -> None:
    with pytest.raises(UsageError, match="distortion loud; there are squared and weighted"):
        EncodeSettings(distortion="loud")
    with pytest.raises(UsageError, match="the paper profile has a loss of its own"):
        EncodeSettings(distortion="weighted", profile="paper")


def test_the_command_line_offers_all() -> None:
    option = next(parameter for parameter in command.params if parameter.name == "distortion")
    assert list(option.type.choices) == list(DISTORTIONS)  # type: ignore[attr-defined]
