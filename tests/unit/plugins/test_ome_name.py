"""OME-TIFF is known by its name."""

from __future__ import annotations

import pytest

from sgicodec.plugins.ome_name import is_ome_name


@pytest.mark.parametrize("name", ["a.ome.tif", "folder/a.OME.TIFF", "s3://bucket/a.b.ome.tiff"])
def test_names_of_ome_tiff(name: str) -> None:
    assert is_ome_name(name)


@pytest.mark.parametrize("name", ["a.tif", "ome.tif", "a.ome.tif.png", "a.ome.tiff/b", "aXome.tif"])
def test_other_names(name: str) -> None:
    assert not is_ome_name(name)
