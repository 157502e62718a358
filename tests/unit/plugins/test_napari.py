"""Streams in napari: what npe2, by which it finds and calls its readers, makes of ours."""

from __future__ import annotations

from pathlib import Path

import npe2
import numpy as np
import pytest

import sgicodec
from sgicodec.errors import StreamError
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.napari import get_reader, read

GOLDEN = Path(__file__).parents[2] / "conformance" / "golden"
PICTURES = Path(__file__).parents[2] / "data" / "pictures"


@pytest.fixture(scope="module")
def manager() -> npe2.PluginManager:
    """That of napari, which has looked for installed plugins."""
    found = npe2.PluginManager.instance()
    found.discover()
    return found


def test_the_manifest_is_found(manager: npe2.PluginManager, pyramid: Path) -> None:
    manifest = manager.get_manifest("sgicodec")
    assert manifest.package_metadata is not None
    assert [reader.command for reader in manager.iter_compatible_readers([str(pyramid)])] == ["sgicodec.read"]


def test_npe2_reads_all_levels(manager: npe2.PluginManager, pyramid: Path) -> None:
    ((data, options, kind),) = npe2.read([str(pyramid)], stack=False)
    assert (kind, options["name"], options["rgb"], options["multiscale"]) == ("image", "pyramid", True, True)
    with sgicodec.open(pyramid) as stream:
        assert [array.shape for array in data] == [(300, 520, 3), (150, 260, 3), (75, 130, 3)]
        np.testing.assert_array_equal(np.asarray(data[2]), stream.read(size=(130, 75)))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("rgb8", {"rgb": True}),
        ("rgba8", {"rgb": True}),
        ("gray16", {"contrast_limits": [0.0, 65535.0]}),
        ("multi8", {"contrast_limits": [0.0, 255.0], "channel_axis": 2}),
    ],
)
def test_layers(name: str, expected: dict[str, object]) -> None:
    ((data, options, _),) = read(str(GOLDEN / f"{name}.sgi"))
    shown = {key: options[key] for key in ("rgb", "contrast_limits", "channel_axis") if key in options}
    assert shown == expected
    assert not options["multiscale"]
    np.testing.assert_array_equal(np.asarray(data), sgicodec.imread(GOLDEN / f"{name}.sgi"))


def test_pixels_have_a_size() -> None:
    rows = bytes.fromhex(
        "0300 1a01 0500 0100 0000 3200 0000 1b01 0500 0100 0000 3a00 0000 2801 0300 0100 0000 0300 0000"
    )
    geo = b"II*\0\x08\0\0\0" + rows + bytes.fromhex("0000 0000 409c 0000 0100 0000 204e 0000 0100 0000")
    picture = Picture(np.zeros((8, 9, 1), np.uint8), "gray", (0, 255), Metadata(geo=geo))
    data = sgicodec.encode(picture, steps=1)
    with sgicodec.open(data) as stream:
        from sgicodec.plugins.napari import _layer

        options = _layer(stream)[1]
    assert (options["scale"], options["units"]) == ((0.5, 0.25), ("um", "um"))


def test_what_it_does_not_read(pyramid: Path, tmp_path: Path) -> None:
    assert get_reader(str(pyramid)) is read
    assert get_reader([str(pyramid), str(PICTURES / "hopper.sgi")]) is None
    assert get_reader(str(tmp_path / "none.sgi")) is None
    assert get_reader("https://example.org/a.sgi") is read
    (tmp_path / "cut.sgi").write_bytes(pyramid.read_bytes()[:100])
    with pytest.raises(StreamError):
        read(str(tmp_path / "cut.sgi"))
