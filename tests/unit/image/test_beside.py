from __future__ import annotations

import os
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
        ("a.tif.aux.xml", b'<Metadata><MDI key="STATISTICS_MEAN">5</MDI></Metadata><Histograms/>', False),
        ("a.tif.aux.xml", b'<Metadata domain="IMAGE_STRUCTURE"><MDI key="A">5</MDI></Metadata>', False),
        ("a.tif.aux.xml", b'<Metadata><MDI key="CLOUD">5</MDI></Metadata>', True),
        ("a.tif.aux.xml", b'<Metadata domain="xml:A" format="xml"><a/></Metadata>', True),
        ("a.tif.aux.xml", b'<PAMRasterBand band="1"><Scale>0.1</Scale></PAMRasterBand>', True),
        ("a.tif.aux.xml", b"<CategoryNames>\n<Category>a</Category></CategoryNames>", True),
        ("A.Tfw", b"10", True),
        ("a_RPC.TXT", b"LINE_OFF: 1", True),
        ("a_rpc.txt", b"LINE_OFF: 1", True),
        ("a.RPB", b"IMAGE", True),
        ("a.tif.vat.dbf", b"\3", True),
        ("a.clr", b"1 0 0 255", True),
        ("ab.tfw", b"10", False),
        ("a.tif.ovr", b"", False),
    ],
)
def test_files_that_say_more_are_named(name: str, contents: bytes, is_said: bool, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(contents)
    assert files_beside(tmp_path / "a.tif") == [name] * is_said


def test_a_name_without_an_ending_has_none_beside_it(tmp_path: Path) -> None:
    (tmp_path / "w").mkdir()
    assert files_beside(tmp_path / "a") == []


def test_names_that_are_no_utf8_can_be_said(tmp_path: Path) -> None:
    name = os.fsdecode(b"a\xff")
    (tmp_path / f"{name}.tfw").write_bytes(b"10")
    assert files_beside(tmp_path / f"{name}.tif") == ["a\ufffd.tfw"]
