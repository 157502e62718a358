from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from image_files import notes_of, save

PIXELS = np.random.default_rng(0).random((6, 8, 3), np.float32)


@pytest.mark.parametrize(
    ("name", "how", "said"),
    [
        ("a.exr", {}, ()),
        ("a.exr", {"PixelAspectRatio": 1.0, "Software": "x", "oiio__ColorSpace": "x"}, ()),
        ("a.exr", {"Artist": "x", "PixelAspectRatio": 2.0}, ("not kept: Artist, PixelAspectRatio",)),
        (
            "a.exr",
            {f"own{i}": "x" for i in range(8)},
            (f"not kept: {', '.join(f'own{i}' for i in range(6))}, 2 more attributes",),
        ),
        ("a.exr", {"at": (3, -2)}, ("not kept: its place at 3, -2 in a window of 8×6 pixels",)),
        ("a.exr", {"PixelAspectRatio": "square", "chromaticities": 1}, ("not kept: chromaticities",)),
        ("a.hdr", {}, ()),
        ("a.dpx", {}, ()),
        ("a.dpx", {"oiio__ColorSpace": "KodakLog"}, ("not kept: colour space (Logarithmic)",)),
        ("a.tga", {"ImageDescription": "x"}, ("not kept: ImageDescription",)),
        ("a.tif", {"Artist": "x"}, ()),
    ],
)
def test_what_a_header_says_is_named(name: str, how: dict[str, object], said: tuple[str, ...], tmp_path: Path) -> None:
    pixels = (PIXELS * 255).astype(np.uint8) if name.endswith(("tga", "tif")) else PIXELS
    path = save(tmp_path / name, pixels, **how)  # type: ignore[arg-type]
    assert notes_of(path) == said


def test_names_of_channels_are_not_kept(tmp_path: Path) -> None:
    path = save(tmp_path / "a.exr", PIXELS, channels=("N.x", "N.y", "N.z"))
    assert notes_of(path) == ("not kept: names of channels",)
