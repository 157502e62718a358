"""Streams that claim more than they hold are refused before memory is taken for the claim."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from data_files import GOLDEN
from little_memory import printed, read_with_little_memory
from surgery import frame, join, split, with_fields, with_hash
from symbols import SymbolWriter, write_base, write_positions, write_tree, write_weights

from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.header import decode_header
from sgicodec.bitstream.parts.tile import read_tile
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, LimitError
from sgicodec.model.base import base_shape
from sgicodec.model.quantization import STEP_COUNT
from sgicodec.model.steps import default_plan

pytest.importorskip("resource")

LUMA_SPACE = 16


def test_headers_that_claim_too_much(coded: Any, tmp_path: Path) -> None:
    most = {"width": 2**24, "height": 2**24}
    plain = {"flags": lambda flags: flags & ~LUMA_SPACE}
    is_adaptive = open_stream(coded.data).header.spec.plain  # then a seed is one Gaussian, whatever the header
    seeds = {"features": 67} if is_adaptive else {"features": 2**13, "hidden": 2**12, "per_seed": 64}
    lies = {
        "pixels": most,
        "everything": most | plain | {"channels": 64, "layout": 0} | seeds,
        "wide": {"width": 2**24, "base_cell": 1},
        "base": {"width": 2**14, "height": 2**14, "base_cell": 1},
        "networks": {"hidden": 4096, "features": 4096, "context_hidden": 4096},
        "context": {"context_hidden": 4096, "features": 8192, "prior": 0},
        "side": {"width": 2**24 + 1},
        "huge": {"height": 2**63 - 1},
        "channels": {"channels": 65, "layout": 0},
        "levels": {"levels": 2**40},
    }
    for name, fields in lies.items():
        (tmp_path / name).write_bytes(with_fields(coded.data, **fields))
    (tmp_path / "hash").write_bytes(with_hash(coded.data, [2**14] * 32, 64, 20))
    (tmp_path / "hash resolution").write_bytes(with_hash(coded.data, [2**14 + 1], 4, 13))
    results = read_with_little_memory(tmp_path)
    assert len(results) == len(lies) + 2
    contradictions = {"networks", "context", "hash"} if is_adaptive else set()
    for name, (kind, message) in results.items():
        expected = "CorruptStreamError" if name in contradictions else "LimitError"
        assert kind == expected, (name, kind, message)


def test_headers_that_claim_as_much_as_is_allowed(coded: Any, tmp_path: Path) -> None:
    """These pass the caps: the payload runs dry or says something else, and that must cost little memory too."""
    for name, fields in {
        "pixels": {"width": 2**15, "height": 2**15},
        "row": {"width": 2**24, "height": 1},
        "hidden": {"hidden": 1024, "features": 1024, "per_seed": 64},
        "context": {"context_hidden": 4096, "prior": 0},
        "gaussians": {"per_seed": 64, "features": 4288, "channels": 64, "layout": 0},
    }.items():
        (tmp_path / name).write_bytes(with_fields(coded.data, **fields))
    (tmp_path / "hash").write_bytes(with_hash(coded.data, [2**14] * 4, 1, 20))
    results = read_with_little_memory(tmp_path)
    assert len(results) == 6
    assert {kind for kind, _ in results.values()} <= {"CorruptStreamError", "LimitError", "UnsupportedStreamError"}


def test_chunk_lengths(coded: Any, tmp_path: Path) -> None:
    """No memory is taken for bytes that do not come."""
    start = SIGNATURE + frame("H", split(coded.data)[0][1])
    for length in (50, 2**20, 2**30, 2**30 + 1, 2**62, 2**63 - 1):
        (tmp_path / str(length)).write_bytes(start + frame("T", bytes(20), length))
    (tmp_path / "varint").write_bytes(start + b"T" + b"\xff" * 20)
    (tmp_path / "padded").write_bytes(start + b"T\x80\x00" + bytes(30))
    results = read_with_little_memory(tmp_path)
    assert len(results) == 8
    for name, (kind, message) in results.items():
        assert kind == "CorruptStreamError", (name, kind, message)


def test_chunks_that_are_really_too_long(coded: Any, tmp_path: Path) -> None:
    path = tmp_path / "long.sgi"
    start = SIGNATURE + frame("H", split(coded.data)[0][1])
    with path.open("wb") as file:
        file.write(start + frame("T", b"", 2**30 + 1)[:-4])
        file.truncate(file.tell() + 2**30 + 100)  # a hole: takes no place on the disk
    (kind, message) = read_with_little_memory(tmp_path)["long.sgi"]
    assert kind == "LimitError", message


def test_free_seeds_are_few(coded: Any) -> None:
    """A seed in every cell takes few bits of the payload, but a decoder takes memory for each."""
    adaptive = decode_header(split(coded.data)[0][1]).spec.layout == "adaptive"
    least = int(adaptive)
    side = 2**10 << least
    header = decode_header(split(with_fields(coded.data, width=side, height=side))[0][1])
    y, x = (axis.reshape(-1) << least for axis in np.mgrid[: 2**10, : 2**10])
    seeds = np.stack([x, y], axis=1).astype(np.int32), np.full(x.size, least, np.int8)
    walk = _up_to_positions(header)
    write = write_tree if adaptive else write_positions
    write(walk, (side, side), seeds)
    payload = walk.finish()
    assert len(payload) < x.size // 4
    with pytest.raises(LimitError, match="seeds"):
        read_tile(header, payload)


def test_a_tree_of_too_many_nodes() -> None:
    """A level takes a byte for each of its nodes as soon as one above it is split."""
    stream = with_fields((GOLDEN / "gray16.sgi").read_bytes(), width=2**15, height=2**15)
    header = decode_header(split(stream)[0][1])
    payload = _up_to_positions(header).finish()
    with pytest.raises(LimitError, match="nodes of a tree of seeds"):
        read_tile(header, payload)


def _steps(header: Any) -> SymbolWriter:
    walk = SymbolWriter()
    for name, index in default_plan(header.spec, header.colour_step).base.items():
        write_weights(walk, np.zeros_like(index))
        if header.spec.plain and name != "colour":
            walk.code_int(0, 6)
    return walk


def _up_to_positions(header: Any) -> SymbolWriter:
    walk = _steps(header)
    if header.spec.base_cell:
        walk.code_int(0, 8)
        shape = (header.spec.channels, *base_shape(header.width, header.height, header.spec.base_cell))
        write_base(walk, np.zeros(shape, np.int64))
    return walk


def test_steps_outside_their_table(coded: Any) -> None:
    header = decode_header(split(coded.data)[0][1])
    first = next(iter(default_plan(header.spec, header.colour_step).base.values()))
    for difference in (STEP_COUNT, -STEP_COUNT, 2**20):
        walk = SymbolWriter()
        write_weights(walk, np.full(first.shape, difference))
        with pytest.raises(CorruptStreamError, match="steps"):
            read_tile(header, walk.finish())


def test_base_step_outside_its_table(coded: Any) -> None:
    header = decode_header(split(with_fields(coded.data, base_cell=32))[0][1])
    walk = _steps(header)
    walk.code_int(STEP_COUNT, 8)
    with pytest.raises(CorruptStreamError, match="step"):
        read_tile(header, walk.finish())


@pytest.mark.parametrize("low_high", [(1.0, 1.0), (2.0, 1.0), (float("nan"), 1.0), (0.0, float("inf")), (-3e38, 3e38)])
def test_sample_ranges_that_are_none(coded: Any, low_high: tuple[float, float]) -> None:
    (_, header), *others = split(with_fields(coded.data, sample_type=2))
    data = join([("H", header + struct.pack("<2f", *low_high)), *others])
    with pytest.raises(CorruptStreamError, match="sample range"):
        open_stream(data)
    assert open_stream(join([("H", header + struct.pack("<2f", 0, 2)), *others])).picture().pixels.max() <= 2


def test_what_wrote_a_stream_cannot_steer_the_terminal(coded: Any) -> None:
    parts = [
        ("s", b"\x1b]0;title\x07\n" + b"x" * 10_000) if kind == "s" else (kind, p) for kind, p in split(coded.data)
    ]
    with open_stream(io.BytesIO(join(parts))) as stream:
        assert stream.software.isprintable()
        assert len(stream.software) <= 200


HUNGRY = """
import resource
import numpy as np
from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer
count, memory = 200_000, 1 << 29
means = np.full((count, 2), 200, np.float32)
shapes = np.tile(np.float32([1e6, 0, 1e6]), (count, 1))
colours = np.ones((count, 1), np.float32)
raster = NativeRasterizer(Device({threads}), most_pairs=1 << 40)
raster.forward(means[:9], shapes[:9], colours[:9], 1600, 800)
resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
try:
    raster.forward(means, shapes, colours, 1600, 800)
except MemoryError:
    print("too little memory")
print(raster.forward(means[:9], shapes[:9], colours[:9], 1600, 800).max().round())
"""


@pytest.mark.parametrize("threads", [1, 2])
def test_memory_runs_out(threads: int) -> None:
    """A picture that it does not suffice for ends in an error, not in an abort, whichever thread runs out."""
    assert printed(HUNGRY.format(threads=threads)) == "too little memory\n9.0\n"
