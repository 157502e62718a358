"""Streams that take a context model of their own along."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import ROOT, crop

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.bitstream.parts.prior import load_prior, parse_prior
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import UsageError
from sgicodec.model.network import IntNetwork
from sgicodec.profiles.default import default_spec
from tests.support.prior_file import prior_file

QUICK = EncodeSettings(quality=45, steps=60)
SHIPPED = (ROOT / "sgicodec" / "bitstream" / "parts" / "prior1.bin").read_bytes()


@pytest.fixture(scope="module")
def photo() -> Picture:
    return crop("kodim23", np.s_[100:228, 180:340])


def changed(networks: tuple[IntNetwork, ...]) -> bytes:
    """Networks that predict larger scales."""
    found = []
    for network in networks:
        b2 = network.b2.copy()
        b2[network.predicted : 2 * network.predicted] += 1 << network.shift
        found.append(replace(network, b2=b2))
    return prior_file(found)


def test_a_file_has_its_networks() -> None:
    spec = default_spec(3)
    networks = parse_prior(SHIPPED, spec)
    for own, shipped in zip(networks, load_prior(spec), strict=True):
        assert (own.shift, own.predicted) == (shipped.shift, shipped.predicted)
        assert all(np.array_equal(a, b) for a, b in zip(own.arrays, shipped.arrays, strict=True))
    assert prior_file(networks) == SHIPPED


@pytest.mark.parametrize("tile", [0, 80])
def test_the_shipped_one_gives_the_same_picture(photo: Picture, tile: int) -> None:
    settings = replace(QUICK, tile=tile, overview=bool(tile))
    plain, own = (encode_picture(photo, replace(settings, prior=prior)).data for prior in (None, SHIPPED))
    with open_stream(plain) as stream, open_stream(own) as other:
        assert (stream.header.spec.context.prior, other.header.spec.context.prior) == (1, 0)
        assert len(own) > len(plain) + 5000
        np.testing.assert_array_equal(stream.picture().pixels, other.picture().pixels)


def test_another_one_is_used(photo: Picture) -> None:
    own = changed(load_prior(default_spec(3)))
    with open_stream(encode_picture(photo, replace(QUICK, prior=own)).data) as stream:
        assert prior_file(stream.model.networks) == own
        error = stream.picture().pixels.astype(float) - photo.pixels
        assert np.square(error).mean() < 150


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "network 1 is not one of"),
        (SHIPPED[:-2], "ends within network 3"),
        (SHIPPED + b"\0", "has 17605 bytes, not 17604"),
        (SHIPPED[:8] + b"\x50\0" + SHIPPED[10:], "too large"),
    ],
)
def test_a_file_that_is_none_is_refused(photo: Picture, data: bytes, says: str) -> None:
    with pytest.raises(UsageError, match=rf"^this is no prior: .*{says}"):
        encode_picture(photo, replace(QUICK, prior=data))


def test_the_paper_profile_trains_its_own(photo: Picture) -> None:
    with pytest.raises(UsageError, match="prior is a setting of the default profile"):
        encode_picture(photo, EncodeSettings(profile="paper", steps=5, prior=SHIPPED))
