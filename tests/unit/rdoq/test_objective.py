"""What a model leaves, against the stream as written and read."""

import io
from dataclasses import replace

import numpy as np
import pytest
from rough_models import stage

from sgicodec.bitstream.container import ChunkWriter
from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import TileModel, write_tile
from sgicodec.decoder.stream import open_stream
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec
from sgicodec.rdoq import Objective, can_optimise


def stream_of(objective: Objective, model: TileModel) -> bytes:
    """A whole stream."""
    payload, _ = write_tile(objective.header, model)
    buffer = io.BytesIO()
    writer = ChunkWriter(buffer)
    writer.write("H", encode_header(objective.header))
    writer.write("T", payload)
    writer.finish()
    return buffer.getvalue()


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_what_is_left_is_what_the_stream_leaves(channels: int) -> None:
    """For one base layer after another, so that none is taken for another."""
    objective, model = stage(channels)
    for seed in range(3):
        base = np.random.default_rng(seed).integers(-9, 9, model.base.shape)
        based = replace(model, base=base)
        left = objective.picture - open_stream(stream_of(objective, based)).render().transpose(2, 0, 1)
        found = objective.decoded_residual(based)
        np.testing.assert_allclose(found[:, :, : left.shape[2]], left, atol=1e-5)
        assert not found[:, :, left.shape[2] :].any()


@pytest.mark.parametrize(
    ("spec", "known"),
    [
        (default_spec(3), True),
        (default_spec(1), True),
        (default_spec(64, prior=0), True),
        (paper_spec(3), False),
    ],
)
def test_which_models_it_knows(spec: ModelSpec, known: bool) -> None:
    assert can_optimise(spec) == known
