"""The peers on a small picture: do they run as their settings say, and do their ladders rise?"""

from __future__ import annotations

import numpy as np
import pytest

from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import PEERS, Peer, find_peers
from sgicodec.errors import UsageError
from sgicodec.metrics.psnr import psnr

pytest.importorskip("imagecodecs")

ALL = list(PEERS.values())
NAMES = [peer.name for peer in ALL]


def picture(height: int = 96, width: int = 128) -> Pixels8:
    """Smooth colours, an edge and some grain."""
    y, x = np.mgrid[:height, :width]
    planes = [128 + 90 * np.sin(x / 17 + k) * np.cos(y / (11 + k)) + 40 * (x + 2 * y > 150) for k in range(3)]
    grain = np.random.default_rng(1).normal(0, 4, (height, width, 1))
    return np.clip(np.stack(planes, axis=2) + grain, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("peer", ALL, ids=NAMES)
def test_ladder_rises_in_rate_and_quality(peer: Peer) -> None:
    pixels = picture()
    trips = [peer.round_trip(pixels, quality) for quality in peer.ladder]
    assert all(trip.pixels.shape == pixels.shape and trip.pixels.dtype == np.uint8 for trip in trips)
    sizes = [len(trip.data) for trip in trips]
    assert 6 <= len(sizes) <= 9
    assert sizes[-1] > 2 * sizes[0]
    assert sorted(sizes) == sizes
    first, last = (psnr(pixels, trip.pixels) for trip in (trips[0], trips[-1]))
    assert last > first + 4
    assert last > 30
    assert all(trip.encode_seconds > 0 and trip.decode_seconds > 0 for trip in trips)


@pytest.mark.parametrize("peer", ALL, ids=NAMES)
def test_every_point_has_settings_of_its_own(peer: Peer) -> None:
    lines = {peer.settings(quality) for quality in peer.ladder}
    assert len(lines) == len(peer.ladder)
    assert not any(set("\t\n") & set(line) for line in lines)
    assert peer.version()


def test_unknown_names_are_refused() -> None:
    with pytest.raises(UsageError, match="no codec is called 'bpg'"):
        find_peers(["bpg"])
