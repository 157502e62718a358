"""Butteraugli with gradients, compared with the program of libjxl and with finite differences."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

torch = pytest.importorskip("torch")
from torch_butteraugli import Reference  # noqa: E402

DATA = Path(__file__).parents[1] / "data"


def crop(name: str, box: tuple[int, int, int, int], quality: int, folder: Path) -> list[Path]:
    """A crop of a picture, and what JPEG makes of it, as PNG."""
    paths = [folder / "original.png", folder / "decoded.png"]
    with Image.open(DATA / name) as picture:
        picture.crop(box).save(paths[0])
    with Image.open(paths[0]) as original:
        original.save(folder / "decoded.jpg", quality=quality)
    with Image.open(folder / "decoded.jpg") as decoded:
        decoded.save(paths[1])
    return paths


def planes(path: Path) -> torch.Tensor:
    with Image.open(path) as picture:
        return torch.from_numpy(np.asarray(picture).transpose(2, 0, 1).astype(np.float32)) / 255


@pytest.mark.skipif(shutil.which("butteraugli_main") is None, reason="needs butteraugli_main of libjxl")
@pytest.mark.parametrize(
    ("name", "box", "quality"),
    [
        ("kodim13.png", (200, 100, 328, 228), 20),
        ("kodim13.png", (300, 300, 393, 371), 80),
        ("kodim23.png", (100, 60, 111, 73), 30),
    ],
)
def test_agrees_with_libjxl(name: str, box: tuple[int, int, int, int], quality: int, tmp_path: Path) -> None:
    paths = crop(name, box, quality, tmp_path)
    command = ["butteraugli_main", *map(str, paths)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    expected = float(text.split("3-norm:")[1].split()[0])
    original, decoded = map(planes, paths)
    assert Reference(original).norm(decoded).item() == pytest.approx(expected, rel=1e-4)


def test_the_gradient_is_that_of_finite_differences(tmp_path: Path) -> None:
    original, decoded = (planes(path).double() for path in crop("kodim23.png", (200, 80, 240, 112), 25, tmp_path))
    reference = Reference(original)
    pixels = decoded.clone().requires_grad_()
    reference.norm(pixels).backward()
    assert pixels.grad is not None
    way = torch.randn(decoded.shape, generator=torch.Generator().manual_seed(3), dtype=torch.float64)
    ahead, behind = (reference.norm(decoded + sign * 1e-8 * way).item() for sign in (1, -1))
    assert (pixels.grad * way).sum().item() == pytest.approx((ahead - behind) / 2e-8, rel=1e-4)


@pytest.mark.parametrize("value", [None, 0.0, 1.0])
def test_gradients_of_equal_pictures_are_finite(value: float | None) -> None:
    generator = torch.Generator().manual_seed(4)
    original = torch.rand(3, 40, 33, generator=generator) if value is None else torch.full((3, 40, 33), value)
    pixels = original.clone().requires_grad_()
    norm = Reference(original).norm(pixels)
    norm.backward()
    assert norm.item() < 1e-5
    assert pixels.grad is not None
    assert torch.isfinite(pixels.grad).all()
