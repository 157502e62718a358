"""Every back end has exactly what the contract states, and draws what the reference does."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest
from scenes import random_scene

from sgicodec.raster import Backend, Background, Mapping, NativeRasterizer, ReferenceRasterizer

CONTRACT = {name: member for name, member in vars(Backend).items() if inspect.isfunction(member) and name[0] != "_"}
BACKENDS = [NativeRasterizer, ReferenceRasterizer]


def parameters(method: Any) -> list[tuple[str, object]]:
    return [(one.name, one.default) for one in inspect.signature(method).parameters.values()]


def test_the_contract_is_what_callers_call() -> None:
    assert set(CONTRACT) == {"forward", "draw", "error"}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", CONTRACT)
def test_signatures(backend: type, name: str) -> None:
    assert parameters(getattr(backend, name)) == parameters(CONTRACT[name])


@pytest.mark.parametrize(("dtype", "mapped"), [(np.uint8, True), (np.float32, True), (np.float32, False)])
def test_back_ends_draw_alike(dtype: type[np.generic], mapped: bool) -> None:
    rng = np.random.default_rng(3)
    scene = random_scene(rng, 20, 3, 30, 20)
    lines = rng.uniform(0, 0.5, (3, 5, 30)).astype(np.float32)
    planes = rng.uniform(-0.2, 0.2, (3, 20, 30)).astype(np.float32)
    down = rng.random((20, 2)).astype(np.float32)
    background = Background(lines, rng.integers(0, 4, 20).astype(np.int32), down, planes)
    mapping = Mapping(np.zeros(3, np.float32), np.full(3, 255, np.float32)) if mapped else None
    images = []
    for backend, kind in ((NativeRasterizer(cutoff=7.0), np.float32), (ReferenceRasterizer(), np.float64)):
        images.append(np.empty((20, 30, 3), dtype))
        backend.draw(*(array.astype(kind) for array in scene), images[-1], (2, -1), background, mapping)
    tolerance = 1e-5 if not mapped else 1.0 if dtype is np.uint8 else 255e-5
    np.testing.assert_allclose(images[0].astype(float), images[1].astype(float), atol=tolerance)
