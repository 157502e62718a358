"""Streams in napari: what npe2, by which it finds and calls its readers, makes of ours; and what its viewer shows."""

from __future__ import annotations

from pathlib import Path

import npe2
import numpy as np
import pytest
from data_files import GOLDEN

import sgicodec
from sgicodec.plugins.napari import read


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
