"""Places in pictures whose busy and differing parts are known."""

from __future__ import annotations

import numpy as np

from sgicodec.bench.places import busiest, most_different

RNG = np.random.default_rng(3)


def with_square(pixels: np.ndarray, x: int, y: int, amplitude: int) -> np.ndarray:
    """Noise of so many levels in a square of 32 pixels."""
    changed = pixels.copy()
    changed[y : y + 32, x : x + 32] += RNG.integers(0, amplitude, (32, 32, 3), np.uint8)
    return changed


def ramp() -> np.ndarray:
    """A smooth picture that is far from even: its variance is large, its fine detail none."""
    return np.broadcast_to(np.linspace(0, 150, 160).astype(np.uint8)[None, :, None], (120, 160, 3)).copy()


def test_the_busiest_place_is_where_the_fine_detail_is() -> None:
    assert busiest(with_square(ramp(), 96, 40, 60), 32, 32) == (96, 40)


def test_a_taken_place_gives_way_to_the_next() -> None:
    pixels = with_square(with_square(ramp(), 96, 40, 60), 16, 80, 30)
    assert busiest(pixels, 32, 32) == (96, 40)
    assert busiest(pixels, 32, 32, [(96, 40)]) == (16, 80)


def test_the_most_different_place_is_where_codecs_disagree_and_not_where_all_are_bad() -> None:
    original = ramp()
    both_bad = with_square(original, 8, 8, 90)
    one_bad = with_square(both_bad, 64, 72, 40)
    assert most_different(original, [both_bad, one_bad], 32, 32) == (64, 72)


def test_a_window_as_large_as_the_picture_has_one_place() -> None:
    pixels = with_square(ramp(), 96, 40, 60)
    assert busiest(pixels, 160, 120) == busiest(pixels, 160, 120, [(0, 0)]) == (0, 0)
