"""What a model costs, against the stream as written and read."""

import io
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sgicodec.bitstream.container import ChunkWriter
from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import TileModel, write_tile
from sgicodec.decoder.stream import open_stream
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec
from sgicodec.rdoq import Objective, can_optimise

Stage = Callable[..., tuple[Objective, TileModel]]


def stream_of(objective: Objective, model: TileModel) -> tuple[bytes, int]:
    """A whole stream, and the bytes of its tile."""
    payload, _ = write_tile(objective.header, model)
    buffer = io.BytesIO()
    writer = ChunkWriter(buffer)
    writer.write("H", encode_header(objective.header))
    writer.write("T", payload)
    writer.finish()
    return buffer.getvalue(), len(payload)


@pytest.mark.parametrize(("channels", "weighted"), [(1, False), (3, False), (3, True), (4, False)])
def test_cost_is_that_of_the_stream(stage: Stage, channels: int, weighted: bool) -> None:
    """For one base layer after another, so that none is taken for another."""
    objective, model = stage(channels, weighted=weighted)
    weights = objective.reference.weights if weighted else np.ones(objective.picture.shape[1:])
    assert weights is not None
    for seed in range(3):
        base = np.random.default_rng(seed).integers(-9, 9, model.base.shape)
        based = replace(model, base=base)
        data, size = stream_of(objective, based)
        error = open_stream(data).render().astype(np.float64) - objective.picture.transpose(1, 2, 0)
        cost = objective.cost(based)
        assert cost.bits == 8 * size
        assert cost.squared_error == pytest.approx(np.sum(error**2), rel=1e-4)
        assert cost.distortion == pytest.approx(np.sum(weights[..., None] * error**2), rel=1e-4)


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
