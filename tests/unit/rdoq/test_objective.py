"""What a model leaves, and what the search promises of it, against streams as written and read."""

import numpy as np
import pytest
from data_files import crop
from rough_models import stage
from surgery import join

from sgicodec import EncodeSettings, encode_picture
from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import TileModel, write_tile
from sgicodec.decoder.stream import open_stream
from sgicodec.model.colours import to_channels
from sgicodec.picture import to_unit
from sgicodec.rdoq import Objective


def stream_of(objective: Objective, model: TileModel) -> bytes:
    """A whole stream."""
    payload, _ = write_tile(objective.header, model)
    return join([("H", encode_header(objective.header)), ("T", payload), ("E", b"")])


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_what_is_left_is_what_the_stream_leaves(channels: int) -> None:
    objective, model = stage(channels)
    drawn = open_stream(stream_of(objective, model)).render().transpose(2, 0, 1)
    left = objective.target - np.tensordot(to_channels(objective.header.spec), drawn, axes=1)
    found = objective.decoded_residual(model)
    np.testing.assert_allclose(found[:, :, : left.shape[2]], left, atol=1e-5)
    assert not found[:, :, left.shape[2] :].any()


def test_streams_cost_less() -> None:
    """Of a fitted photograph, from what is on disk and what is decoded: J falls by more than two in a hundred."""
    picture = crop("kodim23", np.s_[128:256, 100:292])
    unit, lmbda = to_unit(picture), 0.004
    costs = []
    for has_rdoq in (False, True):
        data = encode_picture(
            picture, EncodeSettings(lmbda=lmbda, steps=150, rdoq=has_rdoq, tune="psnr", texture=False)
        ).data
        error = np.sum((open_stream(data).render().astype(np.float64) - unit) ** 2)
        costs.append(error + lmbda * 8 * len(data))
    assert costs[1] < 0.98 * costs[0]
