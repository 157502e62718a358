"""Streams in napari: what npe2, by which it finds and calls its readers, makes of ours; and what its viewer shows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import npe2
import numpy as np
import pytest

import sgicodec
from sgicodec.errors import StreamError
from sgicodec.metadata import geo, ifd
from sgicodec.picture import Metadata, Picture
from sgicodec.plugins.napari import _layer, get_reader, read

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
    readers = manager.iter_compatible_readers([str(pyramid)])
    ours = [reader.command for reader in readers if not reader.command.startswith("napari")]
    assert ours == ["sgicodec.read"]  # napari's own, where it is installed, claims all that imageio does


def test_npe2_reads_all_levels(manager: npe2.PluginManager, pyramid: Path) -> None:
    ((data, options, kind),) = npe2.read([str(pyramid)], stack=False, plugin_name="sgicodec")
    assert (kind, options["name"], options["rgb"], options["multiscale"]) == ("image", "pyramid", True, True)
    with sgicodec.open(pyramid) as stream:
        assert [array.shape for array in data] == [(300, 520, 3), (150, 260, 3), (75, 130, 3)]
        np.testing.assert_array_equal(np.asarray(data[2]), stream.read(size=(130, 75)))


class TestViewer:
    """The viewer of napari, without its windows. napari takes 70 packages and 220 MB, so no extra brings it."""

    @pytest.fixture
    def viewer(self) -> Any:
        components = pytest.importorskip("napari.components", reason="pip install napari; it needs no Qt here")
        return components.ViewerModel()

    def test_a_pyramid_is_a_multiscale_layer(self, viewer: Any, pyramid: Path) -> None:
        (layer,) = viewer.open(str(pyramid), plugin="sgicodec")
        assert (viewer.layers[0], layer.name, layer.rgb, layer.multiscale) == (layer, "pyramid", True, True)
        assert [level.shape for level in layer.data] == [(300, 520, 3), (150, 260, 3), (75, 130, 3)]
        assert layer.level_shapes.tolist() == [[300, 520], [150, 260], [75, 130]]
        with sgicodec.open(pyramid) as stream:
            assert layer.data_level == 2  # before there is a canvas, the smallest
            np.testing.assert_array_equal(np.asarray(layer.data[2]), stream.read(size=(130, 75)))
            level, value = layer.get_value((8, 12), world=True)
            assert level == 2
            np.testing.assert_array_equal(value, np.asarray(layer.data[2])[2, 3])

    def test_a_size_in_micrometres(self, viewer: Any, tmp_path: Path) -> None:
        (tmp_path / "a.sgi").write_bytes(with_size())
        (layer,) = viewer.open(str(tmp_path / "a.sgi"), plugin="sgicodec")
        assert tuple(layer.scale) == (0.5, 0.25)
        assert [str(unit) for unit in layer.units] == ["micrometer", "micrometer"]
        np.testing.assert_allclose(viewer.layers.extent.world, [[0, 0], [3.5, 2]])  # of pixels' centres

    def test_bands_are_layers(self, viewer: Any) -> None:
        expected = sgicodec.imread(GOLDEN / "multi8.sgi")
        layers = viewer.open(str(GOLDEN / "multi8.sgi"), plugin="sgicodec")
        assert len(layers) == len(viewer.layers) == expected.shape[2]
        for band, layer in enumerate(layers):
            np.testing.assert_array_equal(np.asarray(layer.data), expected[..., band])
            assert tuple(layer.contrast_limits) == (0, 255)

    def test_silicon_graphics_is_refused(self, viewer: Any) -> None:
        with pytest.raises(ValueError, match="sgicodec"):
            viewer.open(str(PICTURES / "hopper.sgi"), plugin="sgicodec")
        assert len(viewer.layers) == 0


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("rgb8", {"rgb": True}),
        ("rgba8", {"rgb": True}),
        ("gray16", {"contrast_limits": [0.0, 65535.0]}),
        ("multi8", {"contrast_limits": [[0.0, 255.0]] * 5, "channel_axis": 2}),
        ("gray8-alpha", {"contrast_limits": [[0.0, 255.0]] * 2, "channel_axis": 2}),
        ("multi16-bands", {"contrast_limits": [[100, 900], [100, 1400], [100, 1900], [0, 11000]], "channel_axis": 2}),
    ],
)
def test_layers(name: str, expected: dict[str, object]) -> None:
    ((data, options, _),) = read(str(GOLDEN / f"{name}.sgi"))
    shown = {key: options[key] for key in ("rgb", "contrast_limits", "channel_axis") if key in options}
    assert shown == expected
    assert not options["multiscale"]
    np.testing.assert_array_equal(np.asarray(data), sgicodec.imread(GOLDEN / f"{name}.sgi"))


def test_bands_are_called_as_in_the_source() -> None:
    item = '<Item name="DESCRIPTION" sample="1" role="description">near infrared</Item>'
    text = f"<GDALMetadata>{item}</GDALMetadata>".encode() + b"\0"
    metadata = Metadata(geo=geo.pack({geo.GDAL_METADATA: ifd.Entry(2, text)}))
    picture = Picture(np.zeros((8, 9, 2), np.uint8), "multi", (0.0, 255.0), metadata)
    with sgicodec.open(sgicodec.encode(picture, steps=1)) as stream:
        assert _layer(stream)[1]["name"] == ["stream 1", "stream near infrared"]


def with_size() -> bytes:
    """A stream of nine columns of 0.25 micrometres and eight rows of 0.5."""
    rows = bytes.fromhex(
        "0300 1a01 0500 0100 0000 3200 0000 1b01 0500 0100 0000 3a00 0000 2801 0300 0100 0000 0300 0000"
    )
    tags = b"II*\0\x08\0\0\0" + rows + bytes.fromhex("0000 0000 409c 0000 0100 0000 204e 0000 0100 0000")
    picture = Picture(np.zeros((8, 9, 1), np.uint8), "gray", (0, 255), Metadata(geo=tags))
    return sgicodec.encode(picture, steps=1)


def test_pixels_have_a_size() -> None:
    with sgicodec.open(with_size()) as stream:
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
