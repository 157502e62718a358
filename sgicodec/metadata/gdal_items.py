"""What GDAL_METADATA says of bands: names, scale and offset, unit, colour, and items of their own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from html import escape
from typing import NamedTuple
from xml.etree import ElementTree

from sgicodec.metadata import geo, ifd
from sgicodec.metadata.filebytes import Bytes

_ASCII = 2
_NO_ITEMS = b"<GDALMetadata>\n</GDALMetadata>\0"
_MAX_TEXT = 1 << 22
"""Bytes that are looked at."""
_STALE = ("statistics_", "approx_statistics_", "tifftag_minsamplevalue", "tifftag_maxsamplevalue")
"""How the names of items begin that speak of the source's samples."""

_STATED = {"scale": "scale", "offset": "offset", "unittype": "unit", "description": "names of bands"} | {
    "": "GDAL's other metadata"
}
"""What items of a role state, in words."""


class _Item(NamedTuple):
    name: str
    value: str
    band: int | None
    role: str
    domain: str


@dataclass
class BandFacts:
    """What is said of a band. A sample stands for `scale` · sample + `offset`; items: whatever else, by name."""

    description: str | None = None
    unit: str | None = None
    scale: float | None = None
    offset: float | None = None
    items: dict[str, str] = field(default_factory=dict)


def band_facts(blob: bytes | None, bands: int) -> list[BandFacts]:
    """Those of so many bands, by the `geo` blob. Statistics are left out: samples are not those of the source."""
    found = [BandFacts() for _ in range(bands)]
    entry = geo.load(blob).get(geo.GDAL_METADATA)
    for item in _items(b"" if entry is None else entry.data):
        if item.band is None or item.band >= bands:
            continue
        facts, role = found[item.band], item.role.lower()
        if role == "description":
            facts.description = item.value or None
        elif role == "unittype":
            facts.unit = item.value or None
        elif role in ("scale", "offset"):
            with suppress(ValueError):
                setattr(facts, role, float(item.value))
        elif not role and not item.domain and not item.name.lower().startswith(_STALE):
            facts.items[item.name] = item.value
    return found


def stated_of_samples(data: Bytes | None) -> list[str]:
    """What a TIFF structure such as the `geo` blob states of samples and bands, in words."""
    entries = ifd.entries(data, {geo.GDAL_METADATA, geo.GDAL_NODATA})
    entry = entries.get(geo.GDAL_METADATA)
    items = list(_items(b"" if entry is None else entry.data))
    roles = {item.role.lower() for item in items if item.role or not item.name.lower().startswith(_STALE)}
    return [word for role, word in _STATED.items() if role in roles] + ["nodata value"] * (geo.GDAL_NODATA in entries)


def domains(blob: bytes | None) -> tuple[bool, bool]:
    """Whether items stand in domains, by the `geo` blob, and whether bands have items outside of any."""
    entry = geo.load(blob).get(geo.GDAL_METADATA)
    items = [] if entry is None else list(_items(entry.data))
    return any(item.domain for item in items), any(
        item.band is not None and not (item.role or item.domain) for item in items
    )


def named_bands(names: Sequence[str]) -> dict[int, ifd.Entry]:
    """The tag that gives bands their names, as GDAL writes it; an empty name is none."""
    text = _with_items(b"", "DESCRIPTION", names)
    return {geo.GDAL_METADATA: ifd.Entry(_ASCII, text)} if text else {}


def with_colours(blob: bytes | None, colours: Sequence[str]) -> bytes | None:
    """The `geo` blob with GDAL's names of what bands show, such as "Red", unless it has any; an empty name is none."""
    entries = geo.load(blob)
    entry = entries.get(geo.GDAL_METADATA)
    stated = b"" if entry is None else entry.data
    if any(item.role == "colorinterp" for item in _items(stated)):
        return blob
    text = _with_items(stated, "COLORINTERP", colours)
    return geo.pack({**entries, geo.GDAL_METADATA: ifd.Entry(_ASCII, text)}) if text != stated else blob


def _with_items(text: bytes, name: str, values: Sequence[str]) -> bytes:
    """The tag's text with items of this name, one for each band whose value is not empty; as it is if it is damaged."""
    items = "".join(
        f'<Item name="{name}" sample="{band}" role="{name.lower()}">{escape(_printable(value), quote=False)}</Item>\n'
        for band, value in enumerate(values)
        if value
    )
    head, end, tail = (text or _NO_ITEMS).rpartition(b"</GDALMetadata>")
    return head + items.encode() + end + tail if items and end else text


def last_colour(text: bytes, bands: int) -> str | None:
    """What GDAL calls the last of so many bands, such as "Undefined", in lower case; None where it says nothing."""
    named = [item.value.lower() for item in _items(text) if item.role == "colorinterp" and item.band == bands - 1]
    return named[-1] if named else None


def _printable(name: str) -> str:
    return "".join(character if character.isprintable() else " " for character in name)


def _items(text: bytes) -> Iterator[_Item]:
    """The items of the tag's text; none of a damaged one, or of one that declares entities."""
    text = text.split(b"\0", 1)[0]
    if len(text) > _MAX_TEXT or b"<!" in text:
        return
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError):
        return
    for item in root.iter("Item"):
        sample = item.get("sample", "")
        band = int(sample) if sample.isascii() and sample.isdecimal() else None
        yield _Item(item.get("name", ""), item.text or "", band, item.get("role", ""), item.get("domain", ""))
