"""Where the picture of a stream lies and how large its pixels are, for `sgi info`, and what a format loses of that."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream
    from sgicodec.metadata.blobs import Metadata


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
        "place": place and asdict(place),
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


_UNKNOWN_TO_GDAL = (271, 272, 18246, 18249, *range(40091, 40096))
"""Make, model, ratings, Windows' tags."""

_SCALING = ("scale", "offset", "unit")
"""What is said of samples and is not true of others."""


def losses(
    metadata: Metadata, nodata: float | None, extension: str, dtype: str | None = None, pyramid: str | None = None
) -> list[str]:
    """What a decode loses of a picture's metadata and nodata value, a line each. dtype: of samples, where it is not the
    stream's; pyramid: its kind, in TIFF.
    """
    stated, has_all_kinds = _of_bands(metadata.geo)
    found, numbers = [], [name for name in stated if dtype and name in _SCALING]
    if dtype and (numbers or dtype == "float32" or lost_outside_tiff(metadata.geo, nodata, dtype)):
        from sgicodec.metadata.layouts import range_text
        from sgicodec.picture import full_range

        lost = f"; {_listed(numbers)} {'are' if numbers[1:] else 'is'} not kept" if numbers else ""
        found.append(f"samples are rescaled to {range_text(full_range(dtype))}{lost}")
    if extension != "tif":
        kept = [*numbers, *["names of bands"] * (extension == "zarr")]
        names = _lost_blobs(metadata, extension) + _lost_places(metadata.geo, nodata, extension, dtype)
        if names := names + [name for name in stated if name not in kept]:
            found.append(f".{extension} does not hold its {_listed(names)}; .tif does")
    if extension == "tif" and pyramid and _has_more_exif(metadata.exif, pyramid == "cog"):
        found.append(f"a {'COG' if pyramid == 'cog' else 'pyramid'} does not hold all of its EXIF; a plain .tif does")
    if pyramid == "cog" and has_all_kinds:
        found.append("a COG does not hold its items of bands without a domain; --pyramid does")
    return found


def _has_more_exif(blob: bytes | None, cog: bool) -> bool:
    """Whether there is more than descriptive tags, of which GDAL does not know some."""
    from sgicodec.metadata import ifd

    with suppress(struct.error):
        return bool(blob and ifd.load(blob, {ifd.EXIF_IFD, ifd.GPS_IFD, *(_UNKNOWN_TO_GDAL if cog else ())}))
    return False


def _lost_blobs(metadata: Metadata, extension: str) -> list[str]:
    held = extension in _TAGS
    names = ["EXIF"] * (metadata.exif is not None and not held) + ["XMP"] * (metadata.xmp is not None and not held)
    return names + ["ICC profile"] * (metadata.icc is not None and extension not in (*_TAGS, "jp2", "jxl"))


def _of_bands(blob: bytes | None) -> tuple[list[str], bool]:
    """What GDAL's metadata state of samples and bands, in words, and whether they have items of both kinds of which a
    COG holds one.
    """
    if blob is None:
        return [], False
    from sgicodec.metadata.gdal_items import domains, stated_of_samples

    return [name for name in stated_of_samples(blob) if name != "nodata value"], all(domains(blob))


def lost_outside_tiff(blob: bytes | None, nodata: float | None, dtype: str | None = None) -> bool:
    """Whether formats other than TIFF lose something of a picture's place, or its nodata value. dtype: see `losses`."""
    return bool(_lost_places(blob, nodata, "", dtype))


def _listed(names: list[str]) -> str:
    return ", ".join(names[:-1]) + (" and " if names[1:] else "") + names[-1] if names else ""


def _lost_places(blob: bytes | None, nodata: float | None, extension: str, dtype: str | None) -> list[str]:
    """extension: empty for any format; dtype: see `losses`."""
    states_nodata = nodata is not None and not (math.isnan(nodata) and dtype in (None, "float32"))  # floats show it
    if blob is None:
        return ["nodata value"] * states_nodata
    from sgicodec.metadata import geo

    tags = geo.load(blob).keys()
    names = ["position"] * bool(tags & geo.PLACE) + ["projection"] * (geo.KEYS in tags)
    names += ["nodata value"] * (states_nodata or geo.GDAL_NODATA in tags)
    return names + ["resolution"] * (extension not in ("", "zarr") and _loses_resolution(blob, extension))


def _loses_resolution(blob: bytes, extension: str) -> bool:
    from sgicodec.metadata import density, jpeg, png

    found, fields = density.density(blob, None), {"png": png.density_field, "jpg": jpeg.density_field}
    return found is not None and (extension not in fields or fields[extension](found) is None)
