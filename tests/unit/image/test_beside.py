from __future__ import annotations

from pathlib import Path

import pytest

from sgicodec.image.beside import files_beside


@pytest.mark.parametrize(
    ("name", "contents", "is_said"),
    [
        ("a.tfw", b"10", True),
        ("a.tifw", b"10", True),
        ("a.wld", b"10", True),
        ("a.prj", b"PROJCS", True),
        ("a.tif.msk", b"", True),
        ("a.xmp", b"<x/>", True),
        ("a.tif.xmp", b"<x/>", True),
        ("a.tif.aux.xml", b"<PAMDataset><SRS>EPSG:4326</SRS></PAMDataset>", True),
        ("a.tif.aux.xml", b"<PAMDataset><Metadata/></PAMDataset>", False),
        ("a.tif.ovr", b"", False),
        ("b.tfw", b"10", False),
    ],
)
def test_files_that_say_more_are_named(name: str, contents: bytes, is_said: bool, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(contents)
    assert files_beside(tmp_path / "a.tif") == [name] * is_said


def test_a_name_without_an_ending_has_none_beside_it(tmp_path: Path) -> None:
    (tmp_path / "w").mkdir()
    assert files_beside(tmp_path / "a") == []
