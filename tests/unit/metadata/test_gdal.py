"""What GDAL writes into tags: numbers, statistics, and what it says of bands."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import tifffile
from hypothesis import given
from hypothesis import strategies as st
from tags import geo_of, text

from sgicodec import read
from sgicodec.metadata import gdal, geo
from sgicodec.metadata.gdal_items import BandFacts, band_facts

NAN = float("nan")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("255 255 255", 255.0),
        ("  7", 7.0),
        ("\t-9999.5abc", -9999.5),
        ("-9999,00", -9999.0),
        ("1,2,3", 1.2),
        ("1_0", 1.0),
        ("0x10", 0.0),
        ("1e", 1.0),
        ("1d3", 1.0),
        ("+5.", 5.0),
        (".5", 0.5),
        ("-3.4028234663852886e+38", -3.4028234663852886e38),
        ("1e400", math.inf),
        *[(text, NAN) for text in ("nan", "NAN", "-nan", "nan(ind)", "1.#QNAN0", "-1.#QNAN", "-1.#IND", "1.#SNAN")],
        *[(text, math.inf) for text in ("inf", "+INF", "Infinity", "1.#INF", "1.#INF00")],
        *[(text, -math.inf) for text in ("-inf", "-1.#INF")],
        *[(text, None) for text in ("", "abc", "none", "nano", "info", "- 5", "--5", ".", "\u0665")],
    ],
)
def test_a_number_is_read_as_gdal_reads_it(text: str, value: float | None) -> None:
    found = gdal.number(text.encode())
    assert found == value or (found is not None and value is not None and math.isnan(found) and math.isnan(value))


@given(st.binary(max_size=20))
def test_any_text_is_a_number_or_none(text: bytes) -> None:
    assert isinstance(gdal.number(text), float | None)


HEAD, TAIL = b"<GDALMetadata>", b"\n</GDALMetadata>\n\0"
KEPT = (
    b'\n  <Item name="SCALE" sample="0" role="scale">0.1</Item>'
    b'\n  <Item name="NOTE" domain="IMAGE">STATISTICS_MEAN is elsewhere</Item>'
    b'\n  <Item name="MY_STATISTICS_X">1</Item>'
)


@pytest.mark.parametrize(
    "item",
    [
        b'<Item name="STATISTICS_MINIMUM" sample="0">100</Item>',
        b"<Item sample='1' name='STATISTICS_VALID_PERCENT'>99.8</Item>",
        b'<Item domain="OTHER" name = "STATISTICS_MEAN" sample="2" >1</Item >',
        b'<Item name="statistics_stddev"/>',
        b'<Item name="APPROX_STATISTICS_MAXIMUM">3</Item>',
        b'<Item name="STATISTICS_APPROXIMATE">YES</Item>',
        b'<Item name="STATISTICS_HISTOBINVALUES">1|2|3|</Item>',
        b"<Histograms><HistItem><HistCounts>1|2</HistCounts></HistItem></Histograms>",
        b"<Histograms/>",
    ],
)
def test_statistics_go_and_all_else_stays(item: bytes) -> None:
    for behind in (KEPT, b"\n<Nested>" + KEPT + b"</Nested>"):
        assert gdal.without_statistics(HEAD + b"\n  " + item + behind + TAIL) == HEAD + behind + TAIL
        assert gdal.without_statistics(HEAD + behind + b"\n " + item + TAIL) == HEAD + behind + TAIL
    assert gdal.without_statistics(HEAD + b"\n" + item + b"\n" + item + TAIL) == b""


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "text",
    ["255 255 255", "\t7abc", "-9999,00", "1,2,3", "1_0", "0x10", "1e", "+5.", "nan", "-1.#QNAN", "1.#INF"],
)
def test_gdal_agrees(tmp_path: Path, text: str) -> None:
    rasterio = pytest.importorskip("rasterio")
    tags = [(42113, 2, len(text) + 1, text, True)]
    tifffile.imwrite(tmp_path / "x.tif", np.zeros((2, 2), np.float64), metadata=None, extratags=tags)
    with rasterio.open(tmp_path / "x.tif") as found:
        np.testing.assert_equal(gdal.number(text.encode()), found.nodata)


ITEM = '<Item name="DESCRIPTION" sample="0" role="description">red</Item>'


def test_what_gdal_writes(tmp_path: Path) -> None:
    rasterio = pytest.importorskip("rasterio")
    profile = {"count": 2, "height": 8, "width": 9, "dtype": "uint16", "photometric": "minisblack"}
    with rasterio.open(tmp_path / "a.tif", "w", driver="GTiff", **profile) as file:
        file.write(np.ones((2, 8, 9), np.uint16))
        file.descriptions, file.units = ("B4 «rouge»", None), ("", "K")
        file.scales, file.offsets = (1e-4, 1), (-0.1, 0)
        file.update_tags(1, wavelength="665 nm", STATISTICS_MEAN="5")
        file.update_tags(2, ns="SENSOR", gain="3")
        file.update_tags(of="all")
    found = band_facts(read(tmp_path / "a.tif").metadata.geo, 2)
    assert found == [BandFacts("B4 «rouge»", None, 1e-4, -0.1, {"wavelength": "665 nm"}), BandFacts(unit="K")]


@pytest.mark.parametrize(
    "stated",
    [
        "",
        "<GDALMetadata>" + ITEM,
        "<GDALMetadata>" + ITEM.replace('"0"', '"5"') + "</GDALMetadata>",
        "<GDALMetadata>" + ITEM.replace('"0"', '"-1"') + "</GDALMetadata>",
        "<GDALMetadata>" + ITEM.replace("description", "scale") + "</GDALMetadata>",
        "<!DOCTYPE a><GDALMetadata>" + ITEM + "</GDALMetadata>",
        "<GDALMetadata>" + ITEM + "</GDALMetadata>" + " " * (1 << 22),
    ],
)
def test_damaged_texts_say_nothing(stated: str) -> None:
    assert band_facts(geo_of({geo.GDAL_METADATA: text(stated)}), 2) == [BandFacts(), BandFacts()]
    assert (
        band_facts(geo_of({geo.GDAL_METADATA: text(f"<GDALMetadata>{ITEM}</GDALMetadata>")}), 2)[0].description == "red"
    )
    assert band_facts(None, 1) == [BandFacts()]
