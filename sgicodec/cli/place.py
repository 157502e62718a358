"""Where the picture of a stream lies and how large its pixels are, for `sgi info`, and what a format loses of that."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sgicodec.metadata.layouts import range_text

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream
    from sgicodec.metadata.blobs import Metadata

__all__ = ["lost_in", "lost_outside_tiff", "place_facts", "place_lines", "rescaling"]


def place_facts(stream: Stream) -> dict[str, Any]:
    """What `sgi info --json` says."""
    from sgicodec.metadata.georeference import georeference, resolution
    from sgicodec.metadata.slides import magnification
    from sgicodec.metadata.tiff import DESCRIPTION, described

    blob, exif = stream.metadata.geo, stream.metadata.exif
    place, scale = georeference(blob, stream.header.width, stream.header.height), resolution(blob, exif)
    description = described(exif).get(DESCRIPTION)
    nodata = stream.nodata
    return {
        "place": place
        and {
            "epsg": place.epsg,
            "name": place.name,
            "bounds": place.bounds,
            "pixel_size": place.pixel_size,
            "unit": place.unit,
            "rotated": place.rotated,
        },
        "nodata": str(nodata) if nodata is not None and not math.isfinite(nodata) else nodata,
        "magnification": None if description is None else magnification(description.data),
        "resolution": scale and {"microns_per_pixel": scale.microns, "stated": scale.stated},
    }


def place_lines(facts: Mapping[str, Any]) -> dict[str, str]:
    """The same in lines of text; none where nothing is stated."""
    lines, place, scale = {}, facts["place"], facts["resolution"]
    if place is not None:
        code = f"EPSG:{place['epsg']}" if place["epsg"] else ""
        unit = f" {place['unit']}" if place["unit"] else ""
        lines["projection"] = ", ".join(filter(None, (code, place["name"]))) or "unknown"
        left, bottom, right, top = (f"{value:.10g}" for value in place["bounds"])
        lines["bounds"] = f"{left} to {right}, {bottom} to {top}{unit}" + (", rotated" if place["rotated"] else "")
        lines["pixel"] = " × ".join(f"{size:.6g}" for size in place["pixel_size"]) + unit
    if facts["nodata"] is not None:
        value = facts["nodata"]
        lines["nodata"] = value if isinstance(value, str) else f"{value:.9g}"
    if scale is not None:
        across, down = scale["microns_per_pixel"]
        size = f"{across:.6g}" if across == down else f"{across:.6g} × {down:.6g}"
        lines["resolution"] = f"{size} µm per pixel ({scale['stated']})"
    if facts["magnification"] is not None:
        lines["objective"] = f"{facts['magnification']}×"
    return lines


_TAGS = ("png", "jpg", "webp")
"""Formats besides TIFF that hold EXIF and XMP."""


def lost_in(metadata: Metadata, nodata: float | None, extension: str, rescaled: bool = False) -> str:
    """What of a picture's metadata and nodata value a format does not hold, in words; empty if nothing. rescaled: but
    for what `rescaling` tells.
    """
    if extension == "tif":
        return ""
    held = extension in _TAGS
    names = ["EXIF"] * (metadata.exif is not None and not held) + ["XMP"] * (metadata.xmp is not None and not held)
    names += ["ICC profile"] * (metadata.icc is not None and extension not in (*_TAGS, "jp2", "jxl"))
    names += _lost_places(metadata.geo, nodata, extension)
    return _listed(names + [name for name in _of_bands(metadata, extension) if not (rescaled and name in _SCALING)])


_SCALING = ("scale", "offset", "unit")


def _of_bands(metadata: Metadata, extension: str) -> list[str]:
    from sgicodec.metadata.gdal_items import stated_of_samples

    kept = ["nodata value"] + ["names of bands"] * (extension == "zarr")  # that value is named as one of its place
    return [name for name in stated_of_samples(metadata.geo) if name not in kept] if metadata.geo else []


def rescaling(metadata: Metadata, nodata: float | None, dtype: str) -> str:
    """What samples of another type than the stream's are and lose, in words; empty where they are no measurements."""
    from sgicodec.picture import full_range

    numbers = [name for name in _of_bands(metadata, "tif") if name in _SCALING]
    if dtype != "float32" and not numbers and not lost_outside_tiff(metadata.geo, nodata):
        return ""
    lost = f"; {_listed(numbers)} {'are' if numbers[1:] else 'is'} not kept" if numbers else ""
    return f"samples are rescaled to {range_text(full_range(dtype))}{lost}"


def lost_outside_tiff(blob: bytes | None, nodata: float | None) -> bool:
    """Whether formats other than TIFF lose something of a picture's place, or its nodata value."""
    return bool(_lost_places(blob, nodata, "png"))


def _listed(names: list[str]) -> str:
    return ", ".join(names[:-1]) + (" and " if names[1:] else "") + names[-1] if names else ""


def _lost_places(blob: bytes | None, nodata: float | None, extension: str) -> list[str]:
    states_nodata = nodata is not None and not math.isnan(nodata)
    if blob is None:
        return ["nodata value"] * states_nodata
    from sgicodec.metadata import geo
    from sgicodec.metadata.density import density

    tags = geo.load(blob).keys()
    names = ["position"] * bool(tags & geo.PLACE) + ["projection"] * (geo.KEYS in tags)
    names += ["nodata value"] * (states_nodata or geo.GDAL_NODATA in tags)
    return names + ["resolution"] * (extension not in ("png", "jpg", "zarr") and density(blob, None) is not None)
