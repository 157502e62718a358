"""Drawing straight to samples against numpy: the image of floats, the background, then clipping and rounding."""

import numpy as np
import pytest
from scenes import ISAS, Scene, random_scene

from sgicodec.device import Device
from sgicodec.raster import Background, Mapping, NativeRasterizer, nothing_behind

WIDTH, HEIGHT = 75, 51

every_isa = pytest.mark.parametrize("isa", ISAS)


def scene_of(channels: int) -> Scene:
    return random_scene(np.random.default_rng(channels), 60, channels, WIDTH, HEIGHT)


def background_of(
    channels: int, width: int = WIDTH, height: int = HEIGHT, planes: np.ndarray | None = None
) -> Background:
    rng = np.random.default_rng(1)
    lines = rng.uniform(0, 0.5, (channels, 9, width)).astype(np.float32)
    return Background(
        lines, np.sort(rng.integers(0, 6, height)).astype(np.int32), rng.random((height, 3)).astype(np.float32), planes
    )


def image_of(raster: NativeRasterizer, scene: Scene, background: Background, origin: tuple[int, int]) -> np.ndarray:
    """[h, w, C] in float32, every operation rounded by itself, in the order in which they are specified."""
    height, width = len(background.top), background.lines.shape[2]
    image = raster.forward(*scene, width, height, origin)
    for tap in range(background.down.shape[1]):
        image += background.lines[:, background.top + tap] * background.down[:, tap, None]
    if background.planes is not None:
        image += background.planes
    return image.transpose(1, 2, 0)


@every_isa
@pytest.mark.parametrize("channels", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("origin", [(0, 0), (5, -3)])
def test_values_as_they_are(isa: str, channels: int, origin: tuple[int, int]) -> None:
    raster, scene, background = NativeRasterizer(Device(2, isa)), scene_of(channels), background_of(channels)
    out = np.empty((HEIGHT, WIDTH, channels), np.float32)
    raster.draw(*scene, out, origin, background)
    np.testing.assert_array_equal(out, image_of(raster, scene, background, origin))
    raster.draw(*scene, out, origin)
    np.testing.assert_array_equal(out, raster.forward(*scene, WIDTH, HEIGHT, origin).transpose(1, 2, 0))


@every_isa
@pytest.mark.parametrize("channels", [1, 3, 4, 5])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_mapped_samples(isa: str, channels: int, dtype: type[np.generic]) -> None:
    raster, scene, background = NativeRasterizer(Device(2, isa)), scene_of(channels), background_of(channels)
    most = np.iinfo(dtype).max if np.issubdtype(dtype, np.integer) else 7.5
    low = np.linspace(0, 3, channels).astype(np.float32)
    mapping = Mapping(low, (np.float32(most) - low).astype(np.float32))
    out = np.empty((HEIGHT, WIDTH, channels), dtype)
    raster.draw(*scene, out, (2, 1), background, mapping)
    value = image_of(raster, scene, background, (2, 1))
    assert value.min() < 0
    assert value.max() > 1
    expected = np.clip(value, 0, 1) * mapping.span + low
    np.testing.assert_array_equal(out, (np.rint(expected) if dtype != np.float32 else expected).astype(dtype))


@every_isa
def test_ties_go_to_even_and_not_a_number_to_zero(isa: str) -> None:
    values = np.array([0.5, 1.5, 2.5, 253.5, np.nan, -1.0, 300.0], np.float32) / np.float32(255)
    lines = values.reshape(1, 1, -1)
    background = Background(lines, np.zeros(1, np.int32), np.ones((1, 1), np.float32))
    nobody = (np.zeros((0, 2), np.float32), np.zeros((0, 3), np.float32), np.zeros((0, 1), np.float32))
    out = np.empty((1, len(values), 1), np.uint8)
    mapping = Mapping(np.zeros(1, np.float32), np.full(1, 255, np.float32))
    NativeRasterizer(Device(1, isa)).draw(*nobody, out, (0, 0), background, mapping)
    exact = values[:4] * np.float32(255)
    assert exact.tolist() == [0.5, 1.5, 2.5, 253.5]
    assert out.ravel().tolist() == [0, 2, 2, 254, 0, 0, 255]


@every_isa
@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("has_lines", [True, False])
def test_planes_are_added_behind(isa: str, channels: int, has_lines: bool) -> None:
    raster, scene = NativeRasterizer(Device(2, isa)), scene_of(channels)
    planes = np.random.default_rng(5).normal(size=(channels, HEIGHT, WIDTH)).astype(np.float32)
    background = background_of(channels, planes=planes) if has_lines else nothing_behind(channels, planes)
    out = np.empty((HEIGHT, WIDTH, channels), np.float32)
    raster.draw(*scene, out, (5, -3), background)
    if has_lines:
        expected = image_of(raster, scene, background, (5, -3))
    else:
        expected = (raster.forward(*scene, WIDTH, HEIGHT, (5, -3)) + planes).transpose(1, 2, 0)
    np.testing.assert_array_equal(out, expected)


def test_writes_into_a_part_of_a_picture() -> None:
    raster, scene, background = NativeRasterizer(Device(2)), scene_of(3), background_of(3, 20, 11)
    whole = np.full((HEIGHT, WIDTH, 3), 9, np.uint8)
    mapping = Mapping(np.zeros(3, np.float32), np.full(3, 255, np.float32))
    raster.draw(*scene, whole[7:18, 30:50], (0, 0), background, mapping)
    part = np.empty((11, 20, 3), np.uint8)
    raster.draw(*scene, part, (0, 0), background, mapping)
    np.testing.assert_array_equal(whole[7:18, 30:50], part)
    whole[7:18, 30:50] = 9
    assert np.all(whole == 9)


@pytest.mark.parametrize("wrong", ["dtype", "columns", "top", "taps", "low", "unmapped", "planes"])
def test_refuses_what_does_not_fit(wrong: str) -> None:
    scene, background = scene_of(3), background_of(3)
    out = np.empty((HEIGHT, WIDTH, 3), np.float64 if wrong == "dtype" else np.uint8)
    low = np.zeros(2 if wrong == "low" else 3, np.float32)
    mapping = None if wrong == "unmapped" else Mapping(low, np.ones(3, np.float32))
    if wrong == "columns":
        out = out[:, ::2]
    elif wrong == "top":
        background = background._replace(top=background.top + np.int32(6))
    elif wrong == "taps":
        background = background._replace(down=background.down[1:].copy())
    elif wrong == "planes":
        background = background._replace(planes=np.zeros((3, HEIGHT, WIDTH - 1), np.float32))
    with pytest.raises(ValueError, match="must be"):
        NativeRasterizer().draw(*scene, out, (0, 0), background, mapping)
