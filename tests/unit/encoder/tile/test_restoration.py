"""The last layer of restoration is fitted to a picture: least squared error, for what its bits are worth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec import read
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.parts.restoration import write_restoration
from sgicodec.device import Device
from sgicodec.encoder.tile import restoration as restoring
from sgicodec.encoder.tile.restoration import adapted
from sgicodec.model.restoration import Restoration
from sgicodec.model.texture_symbols import TextureSteps
from sgicodec.rdoq.texture import TextureSearch

PHOTO = Path(__file__).parents[3] / "data" / "kodim13.png"
ONE = Device(threads=1)
PLAIN = Restoration(1, 400)


def unit(channels: int = 3) -> np.ndarray:
    pixels = read(PHOTO).pixels[300:428, 80:280, :channels]
    return np.ascontiguousarray(pixels.transpose(2, 0, 1), np.float32) / 255


def drawn(picture: np.ndarray) -> np.ndarray:
    """What a layer of texture shows of it."""
    ratios = (16,) * (len(picture) - 1)
    layer = TextureSearch(picture, ONE).at(TextureSteps(400, ratios), 0.1)
    assert layer is not None
    return layer.layer().draw()


def error(restoration: Restoration, shown: np.ndarray, picture: np.ndarray) -> float:
    return float(np.square(picture - shown - restoration.correction(shown)).sum(dtype=np.float64))


def bits(restoration: Restoration) -> float:
    writer = SymbolWriter()
    with writer.part("restoration"):
        write_restoration(writer, restoration)
    return writer.bits["restoration"]


def test_a_known_change_is_found() -> None:
    """A picture that is what a changed network makes of what is drawn comes back with this change."""
    shown = drawn(unit())
    change = np.zeros((3, 145), np.int32)
    change[0, 5], change[1, 77], change[2, 140] = 48, -64, 32
    wanted = shown + Restoration(1, 400, (np.zeros((0, 0), np.int32),) * 3 + (change,)).correction(shown)
    found = adapted(PLAIN, shown, wanted, None, 1e-9, ONE)
    assert [part.size for part in found.changes] == [0, 0, 0, 3 * 145]
    assert error(found, shown, wanted) < 0.03 * error(PLAIN, shown, wanted)


@pytest.mark.parametrize("channels", [1, 3])
def test_it_is_worth_its_bits(channels: int) -> None:
    picture = unit(channels)
    shown = drawn(picture)
    dear, cheap = (adapted(PLAIN, shown, picture, None, lmbda, ONE) for lmbda in (0.1, 0.003))
    before, costs = error(PLAIN, shown, picture), [bits(one) - bits(PLAIN) for one in (dear, cheap)]
    saved = [before - error(one, shown, picture) for one in (dear, cheap)]
    assert costs[1] > 2 * costs[0] > 0
    assert saved[0] > 0.1 * costs[0]
    assert saved[1] - saved[0] > 0.003 * (costs[1] - costs[0])
    assert saved[1] > 0.03 * before
    if channels == 1:
        assert not cheap.changes[3][1:].any()


def test_what_is_not_worth_its_bits_stays() -> None:
    picture = unit()
    shown = drawn(picture)
    assert adapted(PLAIN, shown, picture, None, 1.0, ONE) is PLAIN
    restored = shown + PLAIN.correction(shown)
    assert adapted(PLAIN, shown, restored, None, 1e-9, ONE) is PLAIN


def test_empty_pixels_count_nothing() -> None:
    picture = unit()
    shown = drawn(picture)
    empty = np.zeros(picture.shape[1:], bool)
    empty[:, :90] = True
    spoilt = picture.copy()
    spoilt[:, empty] = 7.0
    one, other = (adapted(PLAIN, shown, wanted, empty, 0.01, ONE) for wanted in (picture, spoilt))
    assert one.changes[3].any()
    np.testing.assert_array_equal(one.changes[3], other.changes[3])


def test_some_of_the_pixels_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a large picture not all are looked at; strips do not show."""
    picture = unit()
    shown = drawn(picture)
    before = error(PLAIN, shown, picture)
    saved = []
    for pixels, strip in ((1 << 18, 1 << 15), (1 << 18, 1000), (1 << 13, 1 << 15)):
        monkeypatch.setattr(restoring, "_PIXELS", pixels)
        monkeypatch.setattr(restoring, "_STRIP", strip)
        saved.append(before - error(adapted(PLAIN, shown, picture, None, 0.01, ONE), shown, picture))
    assert saved[1] == pytest.approx(saved[0], rel=0.02)
    assert saved[0] > saved[2] > 0.8 * saved[0]
