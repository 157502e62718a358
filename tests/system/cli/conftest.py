"""A small picture, its stream, and the command line as a user types it."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import done

from sgicodec import Device, Picture, SgiError, write
from sgicodec.encoder import pipeline as encoder


def scene(width: int = 48, height: int = 32) -> np.ndarray:
    """A smooth ramp with a dark disc and a bright stripe [height, width, 3], uint8."""
    y, x = np.mgrid[:height, :width]
    pixels = np.stack([60 + 3 * x, 200 - 4 * y, 80 + x + 2 * y], axis=2)
    pixels[(x - 15) ** 2 + (y - 14) ** 2 < 64] = (30, 20, 60)
    pixels[(x + y) // 6 == 9] = (240, 230, 90)
    return pixels.clip(0, 255).astype(np.uint8)


@pytest.fixture(scope="session")
def pixels() -> np.ndarray:
    """What scene.png holds."""
    return scene()


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with scene.png, its stream scene.sgi, and float.tif with its stream float.sgi."""
    folder = tmp_path_factory.mktemp("shared")
    write(Picture(scene(), "rgb", (0.0, 255.0)), folder / "scene.png")
    floats = scene().astype(np.float32) * 8 - 300
    write(Picture(floats, "rgb", (float(floats.min()), float(floats.max()))), folder / "float.tif")
    for name in ("scene.png", "float.tif"):
        done("encode", folder / name, "--steps", 12, "-j", 1, "--quiet")
    return folder


@pytest.fixture
def picture(shared: Path, tmp_path: Path) -> Path:
    """scene.png in a folder of its own."""
    return Path(shutil.copy(shared / "scene.png", tmp_path))


@pytest.fixture
def stream(shared: Path, tmp_path: Path) -> Path:
    """scene.sgi in a folder of its own."""
    return Path(shutil.copy(shared / "scene.sgi", tmp_path))


class Stopped(SgiError):
    """Raised in place of a fit."""


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The settings that reach the encoder, which then does nothing."""
    seen: dict[str, Any] = {}

    def record(source: object, settings: encoder.EncodeSettings, *, device: Device, **_: object) -> None:
        seen.update(asdict(settings) | asdict(device))
        raise Stopped("stopped")

    monkeypatch.setattr(encoder, "encode_picture", record)
    return seen
