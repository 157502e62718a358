"""Places of pixels before and after, worked out here from the tags by GeoTIFF's own rules (OGC 19-008r4, annex B)."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tags import doubles, geo_keys

from sgicodec.metadata import geo, ifd, placement
from sgicodec.metadata.orientation import upright

WIDTH, HEIGHT = 9, 6


def _keys(raster_type: int) -> ifd.Entry:
    return geo_keys((1024, 0, 1, 1), (1025, 0, 1, raster_type))


TIED = {33550: doubles(10.0, 20.0, 2.0), 33922: doubles(1.0, 2.0, 0.0, 5e5, 6e6, 100.0)}
MATRIX = {34264: doubles(10.0, 2.0, 0.0, 5e5, 3.0, -20.0, 0.0, 6e6, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)}
PLACED = {
    (name, kind): {**tags, 34735: _keys(kind)} for name, tags in (("tied", TIED), ("matrix", MATRIX)) for kind in (1, 2)
}


def _world(blob: bytes | None, x: float, y: float) -> tuple[float, float]:
    """Model coordinates of the point (x, y), counted from the outer corner of the first pixel."""
    tags = geo.load(blob)
    if tags[34735] == _keys(2):
        x, y = x - 0.5, y - 0.5
    if 34264 in tags:
        assert not tags.keys() & {33550, 33922}
        matrix = np.frombuffer(tags[34264].data, "<f8").reshape(4, 4)
        return tuple((matrix @ (x, y, 0.0, 1.0))[:2].tolist())
    sx, sy, _ = struct.unpack("<3d", tags[33550].data)
    i, j, _, east, north, _ = struct.unpack("<6d", tags[33922].data)
    return east + (x - i) * sx, north - (y - j) * sy


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("form", PLACED)
def test_pixels_stay_where_they_are_when_the_picture_is_turned(form: tuple[str, int], orientation: int) -> None:
    before = geo.pack(dict(PLACED[form]))
    after = placement.oriented(before, orientation, WIDTH, HEIGHT)
    numbered = np.arange(WIDTH * HEIGHT).reshape(HEIGHT, WIDTH, 1)
    turned = upright(numbered, orientation)[..., 0]
    for (row, column), number in np.ndenumerate(turned):
        place = _world(after, column + 0.5, row + 0.5)
        assert place == pytest.approx(_world(before, number % WIDTH + 0.5, number // WIDTH + 0.5), abs=1e-6)


@pytest.mark.parametrize("form", PLACED)
@given(
    corner=st.tuples(st.floats(0, 1000), st.floats(0, 1000)),
    scale=st.tuples(st.floats(0.01, 8), st.floats(0.01, 8)),
    point=st.tuples(st.floats(0, 1000), st.floats(0, 1000)),
)
def test_regions_at_any_scale(
    form: tuple[str, int], corner: tuple[float, float], scale: tuple[float, float], point: tuple[float, float]
) -> None:
    before = geo.pack(dict(PLACED[form]))
    after = placement.view(before, *corner, *scale)
    there = [(p - c) * s for p, c, s in zip(point, corner, scale, strict=True)]
    assert _world(after, *there) == pytest.approx(_world(before, *point), abs=1e-3)


def test_control_points_go_along() -> None:
    points = [(0.0, 0.0), (9.0, 6.0), (2.0, 5.0)]
    ties = doubles(*(value for n, (i, j) in enumerate(points) for value in (i, j, 0.0, 100.0 * n, 7.0, 1.0)))
    after = geo.load(placement.oriented(geo.pack({33922: ties}), 6, WIDTH, HEIGHT))
    rows = np.frombuffer(after[33922].data, "<f8").reshape(-1, 6)
    assert rows[:, :2].tolist() == [[HEIGHT - j, i] for i, j in points]
    assert rows[:, 2:].tolist() == [[0.0, 100.0 * n, 7.0, 1.0] for n in range(3)]


def test_rational_polynomials_count_from_centres() -> None:
    values = np.arange(92.0)
    values[2:4], values[7:9] = (2.0, 4.0), (3.0, 4.5)  # offsets and scales of line and sample
    blob = geo.pack({50844: doubles(*values)})
    after = np.frombuffer(geo.load(placement.view(blob, 2, 1, 3, 2))[50844].data, "<f8")
    assert after[[2, 3, 7, 8]].tolist() == [2.5, 7.0, 6.0, 13.5]
    rest = np.delete(np.arange(92), [2, 3, 7, 8])
    assert after[rest].tolist() == values[rest].tolist()
    assert placement.oriented(blob, 2, WIDTH, HEIGHT) is None
