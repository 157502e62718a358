"""What is no Gaussian, and Gaussians of any size, in every instruction set."""

import numpy as np
import pytest
from examples import examples
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scenes import ISAS, backward, random_scene

from sgicodec.device import Device
from sgicodec.raster.cpu import NativeRasterizer

every_isa = pytest.mark.parametrize("isa", ISAS)

BAD = [np.nan, np.inf, -np.inf, 3e38, -3e38, 1e-45, 0.0, -1.0]


@every_isa
def test_what_is_no_gaussian_does_no_harm(isa: str) -> None:
    good = random_scene(np.random.default_rng(6), 5, 3, 40, 30, sigma=(1.0, 5.0))
    bad_means = [(value, 10.0) for value in BAD[:3]] + [(10.0, value) for value in BAD[:3]]
    bad_shapes = [(value, 0.0, 2.0) for value in BAD[:3] + BAD[-2:]] + [
        (2.0, 0.0, value) for value in BAD[:3] + BAD[-2:]
    ]
    bad_shapes += [(2.0, value, 2.0) for value in BAD[:5]] + [(4.0, 2.0, 1.0), (1.0, 5.0, 1.0), (-1.0, 0.0, -1.0)]
    count = len(bad_means) + len(bad_shapes)
    means = np.array(bad_means + [(10.0, 10.0)] * len(bad_shapes), np.float32)
    shapes = np.array([(2.0, 0.0, 2.0)] * len(bad_means) + bad_shapes, np.float32)
    at = np.arange(5) * count // 5  # the good ones in between
    mixed = (
        np.insert(means, at, good[0], axis=0),
        np.insert(shapes, at, good[1], axis=0),
        np.insert(np.ones((count, 3), np.float32), at, good[2], axis=0),
    )
    kept = at + np.arange(5)
    raster, alone = NativeRasterizer(Device(1, isa)), NativeRasterizer(Device(1, isa))
    np.testing.assert_array_equal(raster.forward(*mixed, 40, 30), alone.forward(*good, 40, 30))
    grad = np.ones((3, 30, 40), np.float32)
    for gradient, expected in zip(backward(raster, mixed, grad), backward(alone, good, grad), strict=True):
        np.testing.assert_array_equal(gradient[kept], expected)
        assert not np.delete(gradient, kept, axis=0).any()


number = st.one_of(st.sampled_from(BAD), st.floats(width=32), st.floats(-50, 50, width=32))


@settings(max_examples=examples(200))
@given(
    st.lists(st.tuples(number, number, number, number, number), min_size=1, max_size=6),
    st.sampled_from(ISAS),
    st.sampled_from([(0, 0), (2**30 - 20, 1 - 2**30), (-7, 1000)]),
)
@example([(1.0, 1e-45, 1e-45, 1e-45, 1.0)], "portable", (0, 0))
def test_any_numbers_end_in_finite_images_and_gradients(
    rows: list[tuple[float, ...]], isa: str, origin: tuple[int, int]
) -> None:
    table = np.array(rows, np.float32)
    colours = np.ones((len(rows), 1), np.float32)
    means, covariances = np.ascontiguousarray(table[:, :2]), np.ascontiguousarray(table[:, 2:])
    raster = NativeRasterizer(Device(1, isa))
    image = raster.forward(means, covariances, colours, 20, 20, origin)
    assert np.all((image >= 0) & (image <= len(rows) + 1e-3))
    for gradient in backward(raster, (means, covariances, colours), np.ones((1, 20, 20), np.float32), origin):
        assert np.isfinite(gradient).all()


@every_isa
def test_huge_gaussians_cover_everything(isa: str) -> None:
    means = np.array([[0, 0], [1e9, -1e9], [-1e30, 1e30]], np.float32)
    covariances = np.array([[1e30, 0, 1e30], [1e30, 1e29, 1e30], [1e38, 0, 1e38]], np.float32)
    colours = np.array([[1.0], [0.5], [0.25]], np.float32)
    image = NativeRasterizer(Device(2, isa)).forward(means, covariances, colours, 700, 500)
    np.testing.assert_allclose(image, 1.5, rtol=1e-5)  # the third lies 1e11 deviations away
