"""The one entrance: the same picture from both back ends, and clear words for wrong arguments."""

from typing import Any

import numpy as np
import pytest
from fake_cuda import fake_gpu
from scenes import random_scene

from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import UsageError
from sgicodec.raster import DEFAULT_CUTOFF, NativeRasterizer, rasterize

SCENE = random_scene(np.random.default_rng(0), 50, 3, 60, 40, sigma=(0.5, 6.0), ratio=4.0)


@pytest.mark.parametrize("scale", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("origin", [(0, 0), (-5, 9)])
def test_back_ends_agree(scale: float, origin: tuple[int, int]) -> None:
    native, reference = (
        rasterize(*SCENE, 60, 40, origin=origin, scale=scale, cutoff=6.0, backend=backend, device=ONE_THREAD)
        for backend in ("native", "reference")
    )
    assert (native.dtype, reference.dtype) == (np.float32, np.float64)
    assert native.shape == reference.shape == (3, 40, 60)
    np.testing.assert_allclose(native, reference, atol=3e-5 * np.abs(SCENE[2]).sum())
    np.testing.assert_allclose(native, reference, atol=2e-4)


def test_a_gpu_draws_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sgicodec.cuda.gpu.opened", lambda index: fake_gpu())
    cpu, gpu = (
        rasterize(*SCENE, 60, 40, scale=0.7, cutoff=6.0, device=device) for device in (ONE_THREAD, Device(1, gpu=0))
    )
    np.testing.assert_array_equal(gpu, cpu)


def test_the_origin_is_in_pixels_of_the_scaled_picture() -> None:
    whole = rasterize(*SCENE, 90, 60, scale=1.5)
    part = rasterize(*SCENE, 20, 10, scale=1.5, origin=(33, 17))
    np.testing.assert_array_equal(part, whole[:, 17:27, 33:53])


def test_defaults_and_plain_lists() -> None:
    image = rasterize(*(array.tolist() for array in SCENE), 60, 40)
    np.testing.assert_array_equal(image, NativeRasterizer(Device(1), cutoff=DEFAULT_CUTOFF).forward(*SCENE, 60, 40))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"backend": "abacus"}, "backend 'abacus'"),
        ({"scale": 0.0}, "scale of 0"),
        ({"scale": float("inf")}, "scale of inf"),
        ({"cutoff": -1.0}, "cutoff of -1"),
        ({"width": 0}, "0×8 pixels"),
        ({"means": np.zeros((4, 3))}, r"\[4, 3\], \[4, 3\], \[4, 1\]"),
        ({"colours": np.zeros((4, 0))}, r"\[4, 2\], \[4, 3\], \[4, 0\]"),
        ({"colours": np.zeros(4)}, r"\[4, 2\], \[4, 3\], \[4\]"),
        ({"means": 1.0}, r"\[1\], "),
    ],
)
def test_wrong_arguments(change: dict[str, Any], message: str) -> None:
    arguments: dict[str, Any] = {
        "means": np.zeros((4, 2)),
        "covariances": np.ones((4, 3)),
        "colours": np.ones((4, 1)),
        "width": 8,
        "height": 8,
    }
    with pytest.raises(UsageError, match=message):
        rasterize(**(arguments | change))
