"""Streams that are rendered on a GPU, of which the kernels are compiled for the host, beside the processor's pixels."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from data_files import GOLDEN
from fake_cuda import backwards, fake_driver, only_gpu, shared_gpu

from sgicodec import decode
from sgicodec.cuda.gpu import GpuArray
from sgicodec.decoder import stream as streams
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.device import Device
from sgicodec.errors import LimitError
from sgicodec.raster import painter
from sgicodec.raster.cuda import CudaRasterizer
from sgicodec.raster.cuda_texture import drawn_texture


@pytest.fixture
def gpu(monkeypatch: pytest.MonkeyPatch) -> Device:
    return only_gpu(monkeypatch)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, ...]]:
    """The shapes of all that the GPU draws."""
    shapes = []
    draw = CudaRasterizer.draw

    def noted(self: CudaRasterizer, *arguments: Any) -> None:
        shapes.append(arguments[3].shape)
        draw(self, *arguments)

    monkeypatch.setattr(CudaRasterizer, "draw", noted)
    return shapes


def check(on_gpu: Stream, on_cpu: Stream, **view: Any) -> None:
    ours, theirs = on_gpu.picture(**view).pixels, on_cpu.picture(**view).pixels
    assert (ours.shape, ours.dtype) == (theirs.shape, theirs.dtype)
    np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("name", sorted(path.stem for path in GOLDEN.glob("*.sgi")))
def test_every_golden_stream(name: str, gpu: Device, drawn: list[tuple[int, ...]]) -> None:
    """Within a level of eight bits, with the same symbols; what has more than four channels the processor draws."""
    path = GOLDEN / f"{name}.sgi"
    with open_stream(path, gpu) as ours, open_stream(path, Device(1)) as theirs:
        check(ours, theirs)
        assert ours.symbol_crc == theirs.symbol_crc
        assert bool(drawn) == (theirs.header.spec.channels <= 4)


@pytest.mark.parametrize("name", ["rgb8-tiles-texture", "rgba8-tiles-luma", "gray16-texture", "rgba8-texture"])
@pytest.mark.parametrize(
    "view",
    [
        {"region": (37, 21, 50, 41)},
        {"region": (-9, -5, 80, 60), "boundless": True},
        {"scale": 0.4},
        {"region": (40, 10, 45, 50), "scale": 2.3},
        {"scale": 0.5, "dtype": "uint8"},
        {"dtype": "float32"},
    ],
)
def test_any_view(name: str, view: dict[str, Any], gpu: Device, drawn: list[tuple[int, ...]]) -> None:
    """Regions, scales, cross-fades of tiles, dither, masks: whatever is composed of what a GPU draws."""
    path = GOLDEN / f"{name}.sgi"
    with open_stream(path, gpu) as ours, open_stream(path, Device(1)) as theirs:
        check(ours, theirs, **view)
    assert drawn


def test_decode_and_bands(gpu: Device, drawn: list[tuple[int, ...]], monkeypatch: pytest.MonkeyPatch) -> None:
    data, textures = (GOLDEN / "rgb8-texture.sgi").read_bytes(), list[tuple[int, ...]]()

    def noted(*arguments: Any) -> GpuArray:
        textures.append(arguments[2])
        return drawn_texture(*arguments)

    monkeypatch.setattr(painter, "drawn_texture", noted)
    whole = decode(data, device=gpu)
    np.testing.assert_array_equal(whole, decode(data))
    assert (drawn, textures) == ([whole.shape], [(3, *whole.shape[:2])])
    with open_stream(data, gpu) as stream:
        parts = [picture.pixels for _, picture in stream.bands()]
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    monkeypatch.setattr(streams, "GPU_BLOCK_SAMPLES", 1 << 14)
    np.testing.assert_array_equal(decode(data, device=gpu), whole)
    assert len(drawn) > 4
    with backwards():
        np.testing.assert_array_equal(decode(data, device=gpu), whole)


@pytest.mark.parametrize("name", ["rgb8-restored", "gray16-restored"])
@pytest.mark.parametrize(("view", "draws"), [({}, 1), ({"region": (9, 7, 101, 83)}, 1), ({"scale": 2.5}, 2)], ids=str)
def test_what_is_restored_is_drawn_at_once(
    name: str,
    view: dict[str, Any],
    draws: int,
    gpu: Device,
    drawn: list[tuple[int, ...]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In its own pixels, and once more as it is shown; blocks, where there are any, do not show."""
    path = GOLDEN / f"{name}.sgi"
    with open_stream(path, Device(1)) as stream:
        theirs = stream.render(**view)
    monkeypatch.setattr(streams, "GPU_BLOCK_SAMPLES", 2 * theirs.size)
    with open_stream(path, gpu) as stream:
        ours = stream.render(**view)
    assert len(drawn) == draws
    np.testing.assert_array_equal(ours, theirs)
    monkeypatch.setattr(streams, "GPU_BLOCK_SAMPLES", theirs.size // 2)
    with open_stream(path, gpu) as stream:
        np.testing.assert_array_equal(stream.render(**view), ours)
    assert len(drawn) >= 5 * draws


def test_threads_take_turns(gpu: Device) -> None:
    """Of one stream and of several, and those that decode ahead."""
    path = GOLDEN / "rgb8-tiles.sgi"
    with open_stream(path, gpu.with_threads(3)) as one:
        expected, found = one.picture(scale=0.5).pixels, list[Any]()

        def draw(stream: Stream) -> None:
            for _ in range(3):
                found.append(stream.picture(scale=0.5).pixels)

        with open_stream(path, gpu.with_threads(3)) as other:
            threads = [threading.Thread(target=draw, args=(stream,)) for stream in (one, other, other)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
    assert len(found) == 9
    assert all(np.array_equal(pixels, expected) for pixels in found)


def test_what_was_drawn_leaves_no_memory(gpu: Device) -> None:
    before = fake_driver().sgi_fake_allocated()
    decode((GOLDEN / "rgb8.sgi").read_bytes(), device=gpu)
    assert fake_driver().sgi_fake_allocated() == before


def test_what_fails_is_said(gpu: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    data = (GOLDEN / "rgb8.sgi").read_bytes()
    monkeypatch.setattr(painter, "MAX_PAIRS", 3)
    with pytest.raises(LimitError, match="decode smaller regions"):
        decode(data, device=gpu)

    def full(*_: Any) -> None:
        raise MemoryError("the GPU has too little memory")

    monkeypatch.setattr(CudaRasterizer, "draw", full)
    for name in ("rgb8", "rgb8-tiles"):
        with pytest.raises(MemoryError, match="too little"), open_stream(GOLDEN / f"{name}.sgi", gpu) as stream:
            stream.picture(scale=0.5)
    assert not shared_gpu().turn.locked()
