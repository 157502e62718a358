"""The program that trains priors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")
from data_files import crop

from sgicodec import EncodeSettings, encode_picture
from sgicodec.bitstream.parts.prior import load_prior, parse_prior
from tests.support.prior_file import prior_file
from tools.train_prior import TrainingNet, seeds_in, train


def test_it_takes_bits_off_and_keeps_steps(tmp_path: Path) -> None:
    picture = crop("kodim23", np.s_[100:228, 180:340])
    settings = EncodeSettings(quality=60, steps=60, texture=False)
    (tmp_path / "a.sgi").write_bytes(encode_picture(picture, settings).data)
    [seeds] = seeds_in(tmp_path)
    spec = seeds.spec
    begin = load_prior(spec)
    trained = train([seeds], 30, 0.002)
    assert parse_prior(prior_file(trained), spec)[0].shift == begin[0].shift
    before, since = (float(seeds.bits(TrainingNet(spec, networks)).detach().mean()) for networks in (begin, trained))
    assert since < before - 0.2
