"""Time limits of pictures in several tiles, by a clock that moves on whenever somebody looks at it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clock import Clock

from sgicodec import Encoded, EncodeSettings, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.listener import NullListener, PassState
from sgicodec.encoder.plan import stream_plan
from sgicodec.encoder.tiles.memory_store import MemoryStore
from sgicodec.encoder.tiles.weight import tile_weight
from sgicodec.image import open_source, write
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Metadata, Picture

GEO_WITH_NODATA_0 = bytes.fromhex("49492a00 08000000 0100 81a40200 02000000 30000000 00000000")


@pytest.fixture
def clock(clock: Clock) -> Clock:
    """A step of a fit takes as many ticks as it looks at the clock, on any machine."""
    clock.tick = 0.02
    return clock


class Stop(NullListener):
    """Presses Ctrl-C after so many tiles."""

    def __init__(self, after: int | None) -> None:
        self.after = after

    def tile(self, state: PassState) -> None:
        if state.done == self.after:
            raise KeyboardInterrupt


def limited(path: Path, limit: float, store: MemoryStore, stop: int | None = None) -> Encoded:
    """An encode of tiles of 64 pixels in this process, interrupted after `stop` tiles."""
    with open_source(path) as source:
        return encode_picture(source, EncodeSettings(time_limit=limit, tile=64), store=store, progress=Stop(stop))


def steps(store: MemoryStore) -> list[int]:
    return [tile.steps for _, tile in sorted(store.tiles.items())]


def test_every_tile_has_its_part_and_the_limit_holds(clock: Clock, photo: Path) -> None:
    """By this clock all steps take the same, so that time by weight is steps by weight."""
    store, began = MemoryStore(), clock.now
    found = limited(photo, 20.0, store)
    assert 17.0 < clock.now - began < 20.0
    counts = steps(store)
    with open_source(photo) as source:
        plan = stream_plan(windows_of(source).shape, EncodeSettings(tile=64))
        weights = [tile_weight(source.read(*plan.header.grid.rect(number)), plan) for number in range(6)]
    assert max(weights) > 1.5 * min(weights)
    each = np.divide(counts, weights)
    assert max(each) < 1.6 * min(each)
    assert min(counts) > 15
    assert found.steps == round(np.mean(counts))
    assert {tile.lmbda for tile in store.tiles.values()} == {found.lmbda}
    with open_stream(found.data) as stream:
        assert stream.software.endswith(" q50 visual t20")
        assert psnr(read(photo).pixels, stream.picture().pixels) > 22


def test_more_time_gives_more_steps_and_a_better_file(clock: Clock, photo: Path) -> None:
    pixels, costs, counts = read(photo).pixels, [], []
    for limit in (6.0, 24.0):
        store = MemoryStore()
        found = limited(photo, limit, store)
        error = np.square((pixels - open_stream(found.data).picture().pixels.astype(float)) / 255).sum()
        costs.append(error + 8 * found.lmbda * len(found.data))
        counts.append(found.steps)
    assert counts[1] > 2.5 * counts[0]
    assert costs[1] < costs[0]


def test_next_to_no_time_gives_a_sound_stream(clock: Clock, photo: Path) -> None:
    store = MemoryStore()
    found = limited(photo, 0.01, store)
    assert max(steps(store)) < 12
    assert psnr(read(photo).pixels, open_stream(found.data).picture().pixels) > 12


def test_blank_tiles_hand_their_time_on(clock: Clock, photo: Path, tmp_path: Path) -> None:
    pixels, counts = np.maximum(read(photo).pixels, 1), []
    for blank in (0, 108):  # two of three columns, aprons included
        pixels[:, :blank] = 0
        path = tmp_path / f"{blank}.tif"
        write(Picture(pixels, "rgb", (0.0, 255.0), Metadata(geo=GEO_WITH_NODATA_0)), path)
        store = MemoryStore()
        found = limited(path, 12.0, store)
        counts.append(steps(store))
        np.testing.assert_array_equal(
            (open_stream(found.data).picture().pixels == 0).all(axis=2), (pixels == 0).all(axis=2)
        )
    assert [count > 0 for count in counts[1]] == [False, False, True] * 2
    assert counts[1][5] > 2 * counts[0][5]
    assert found.steps == round(np.mean([counts[1][2], counts[1][5]]))


def test_the_limit_counts_for_the_run(clock: Clock, photo: Path) -> None:
    """What was finished stays as it is; what is left has all of the new time."""
    store = MemoryStore()
    with pytest.raises(KeyboardInterrupt):
        limited(photo, 12.0, store, stop=4)
    before = dict(store.tiles)
    clock.now += 1000.0
    began = clock.now
    found = limited(photo, 12.0, store)
    assert clock.now - began < 12.0
    assert {version: store.tiles[version] for version in before} == before
    counts = steps(store)
    assert min(counts[4:]) > 2 * max(counts[:4])
    assert psnr(read(photo).pixels, open_stream(found.data).picture().pixels) > 20


def test_a_picture_in_memory(clock: Clock, photo: Path) -> None:
    picture, began = read(photo), clock.now
    encoded = encode_picture(picture, EncodeSettings(time_limit=12.0, tile=64))
    assert 9.0 < clock.now - began < 12.0
    assert psnr(picture.pixels, open_stream(encoded.data).picture().pixels) > 20


def test_a_limit_that_has_begun(clock: Clock, photo: Path) -> None:
    picture = replace(read(photo))
    encode_picture(picture, EncodeSettings(time_limit=50.0, tile=64), started=clock.now - 40)
    began = clock.now
    encode_picture(picture, EncodeSettings(time_limit=50.0, tile=64), started=clock.now - 40)
    assert 7.0 < clock.now - began < 10.0
