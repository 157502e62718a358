"""Planes of OME-TIFF: which directory of the file has which channel, at which z and t."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

from sgicodec.metadata import ifd
from sgicodec.metadata.filebytes import Bytes

_DESCRIPTION = 270
_MAX_TEXT, _MAX_PLANES = 1 << 24, 1 << 20


@dataclass(frozen=True)
class ChannelPlanes:
    """pages: for each z and t, t by t, the number of the directory of each channel; names: of channels, or empty."""

    pages: tuple[tuple[int, ...], ...]
    names: tuple[str, ...]


def channel_planes(data: Bytes, directories: int) -> ChannelPlanes | None:
    """Those of a file of so many pages, if it is one image of OME whose channels, several, have a plane each."""
    entry = ifd.entries(data, {_DESCRIPTION}).get(_DESCRIPTION)
    text = b"" if entry is None else entry.data.rstrip(b"\0 \r\n")
    if not text.endswith(b"OME>") or len(text) > _MAX_TEXT or b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        return None
    try:
        return _planes(ElementTree.fromstring(text), directories)
    except (ElementTree.ParseError, KeyError, ValueError):
        return None


def _planes(root: ElementTree.Element, directories: int) -> ChannelPlanes | None:
    images = root.findall("{*}Image/{*}Pixels")
    if len(images) != 1:
        return None
    pixels = images[0]
    sizes = {axis: int(pixels.attrib[f"Size{axis}"]) for axis in "CZT"}
    count = sizes["C"] * sizes["Z"] * sizes["T"]
    channels = pixels.findall("{*}Channel")
    if sizes["C"] < 2 or not 0 < count <= min(directories, _MAX_PLANES) or len(channels) not in (0, sizes["C"]):
        return None
    found = _directories(pixels, sizes)
    wanted = [
        tuple(found.get((c, z, t), -1) for c in range(sizes["C"]))
        for t, z in itertools.product(range(sizes["T"]), range(sizes["Z"]))
    ]
    if not all(0 <= number < directories for page in wanted for number in page):
        return None
    return ChannelPlanes(tuple(wanted), tuple(channel.get("Name", "") for channel in channels))


def _directories(pixels: ElementTree.Element, sizes: Mapping[str, int]) -> dict[tuple[int, int, int], int]:
    """The directory of each plane (c, z, t) that is stated; none of planes in other files."""
    inner = pixels.attrib["DimensionOrder"][2:]
    if sorted(inner) != ["C", "T", "Z"]:
        raise ValueError(inner)
    order = list(itertools.product(*(range(sizes[axis]) for axis in reversed(inner))))
    keys = [tuple(dict(zip(reversed(inner), place, strict=True))[axis] for axis in "CZT") for place in order]
    if pixels.find("{*}TiffData/{*}UUID[@FileName]") is not None and len(_files(pixels)) > 1:
        return {}
    found: dict[tuple[int, int, int], int] = {}
    for part in pixels.findall("{*}TiffData") or [ElementTree.Element("TiffData")]:
        first = tuple(int(part.get(f"First{axis}", 0)) for axis in "CZT")
        start, at = keys.index(first), int(part.get("IFD", 0))
        count = int(part.get("PlaneCount", 1 if "IFD" in part.attrib else len(keys)))
        for offset, key in enumerate(keys[start : start + count]):
            found[key[0], key[1], key[2]] = at + offset
    return found


def _files(pixels: ElementTree.Element) -> set[str | None]:
    return {part.get("FileName") for part in pixels.findall("{*}TiffData/{*}UUID")}
