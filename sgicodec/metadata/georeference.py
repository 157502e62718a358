"""What the tags of a picture say of its place and scale, in words for people: projection, bounds, resolution."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sgicodec.metadata import density, geo, ifd, slides
from sgicodec.metadata.placement import transformation

_MODEL, _PROJECTED, _GEOGRAPHIC, _GEOCENTRIC = 1024, 1, 2, 3
_EPSG_CODES = range(1024, 32767)
"""32767 stands for a system that the file defines by itself; larger ones are private."""
_OF_PROJECTION = range(3072, 3096)
_PROJECTED_CODE, _PROJECTED_NAME, _NAME, _BASE_CODE, _BASE_NAME = 3072, 3073, 1026, 2048, 2049
"""Keys of the projected coordinate system, of any one, and of the geographic or geocentric one, which may only be the
base of a projected one.
"""
_LENGTHS = {9001: "m", 9002: "ft", 9003: "US survey ft"}
_ANGULAR_UNIT, _DEGREE = 2054, 9102
_LINEAR_UNIT = {_PROJECTED: 3076, _GEOCENTRIC: 2052}
_CITED = re.compile(
    r"(?:PCS Name|GCS Name|Projection Name)\s*=\s*([^|\ufffd]+)" r"|ESRI PE String\s*=\s*\w+\[\"([^\"]+)"
)
"""A name inside a citation of ERDAS, ESRI or GDAL."""

_DESCRIPTION = 270
_MICRONS = {2: 25400.0, 3: 10000.0}
_PER = {2: "inch", 3: "cm"}


@dataclass(frozen=True)
class Georeference:
    """Where a picture lies. epsg and name: of the coordinate system; bounds: left, bottom, right, top in it;
    pixel_size: in x and y, in `unit`; rotated: whether rows run askew to the axes.
    """

    epsg: int | None
    name: str | None
    bounds: tuple[float, float, float, float]
    pixel_size: tuple[float, float]
    unit: str | None
    rotated: bool


@dataclass(frozen=True)
class Resolution:
    """Size of a pixel in x and y in micrometres, and where that is stated."""

    microns: tuple[float, float]
    stated: str


def georeference(blob: bytes | None, width: int, height: int) -> Georeference | None:
    """That of a picture of width × height pixels with this `geo` blob; None without tie point or transformation."""
    matrix = transformation(blob)
    if matrix is None:
        return None
    keys = _keys(blob)
    corners = np.array([[x, y, 1.0] for x in (0, width) for y in (0, height)]) @ matrix.T  # [4, 2]
    low, high = corners.min(axis=0), corners.max(axis=0)
    across, down = np.linalg.norm(matrix[:, 0]), np.linalg.norm(matrix[:, 1])
    return Georeference(
        epsg=_code(keys),
        name=_name(keys),
        bounds=(float(low[0]), float(low[1]), float(high[0]), float(high[1])),
        pixel_size=(float(across), float(down)),
        unit=_unit(keys),
        rotated=bool(matrix[0, 1] or matrix[1, 0]),
    )


Keys = dict[int, int | str]


def _model(keys: Keys) -> int | str:
    """The kind of coordinates; where the file does not say it, projected ones if it says anything of such a system."""
    stated = keys.get(_MODEL)
    return stated or (_PROJECTED if keys.keys() & set(_OF_PROJECTION) else _GEOGRAPHIC)


def _code(keys: Keys) -> int | None:
    """The EPSG code of the coordinates; None for a system that the file defines by itself, whatever its base is."""
    model = _model(keys)
    key = _PROJECTED_CODE if model == _PROJECTED else _BASE_CODE if model in (_GEOGRAPHIC, _GEOCENTRIC) else 0
    code = keys.get(key)
    return code if isinstance(code, int) and code in _EPSG_CODES else None


def _name(keys: Keys) -> str | None:
    """What the file calls the system of its coordinates. The name of a base is none."""
    order = (_PROJECTED_NAME, _NAME) if _model(keys) == _PROJECTED else (_NAME, _BASE_NAME)
    named = (keys.get(key) for key in order)
    text = next((text for text in named if isinstance(text, str) and text), None)
    found = None if text is None else _CITED.search(text)
    return text if found is None else (found[1] or found[2]).strip()


def _unit(keys: Keys) -> str | None:
    model = _model(keys)
    if model == _GEOGRAPHIC:
        return "°" if keys.keys() & {_MODEL, _BASE_CODE} and keys.get(_ANGULAR_UNIT, _DEGREE) == _DEGREE else None
    return _LENGTHS.get(keys.get(_LINEAR_UNIT.get(model, 0), 0))  # type: ignore[arg-type, call-overload]


def _keys(blob: bytes | None) -> Keys:
    """The keys of a GeoKeyDirectory that hold a short or a text; those of doubles are left out."""
    entries = geo.load(blob)
    directory, texts = entries.get(geo.KEYS), entries.get(geo.KEY_TEXTS)
    if directory is None:
        return {}
    rows = np.frombuffer(directory.data[: len(directory.data) // 8 * 8], "<u2").reshape(-1, 4)[1:]
    text = b"" if texts is None else texts.data
    found: Keys = {}
    for key, location, count, value in rows.tolist():
        if location == 0:
            found[key] = value
        elif location == geo.KEY_TEXTS:
            found[key] = _printable(text[value : value + count])
    return found


def _printable(text: bytes) -> str:
    """A text of the file without what could steer a terminal."""
    decoded = text.decode("utf-8", "replace").strip("\0| ")
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in decoded)


def resolution(blob: bytes | None, exif: bytes | None) -> Resolution | None:
    """How large a pixel is, by the description of a slide (Aperio), else by the resolution in the `geo` blob or
    the EXIF; None where nothing says so in a unit of length.
    """
    described = ifd.entries(exif, {_DESCRIPTION, *geo.RESOLUTION})
    text = described.get(_DESCRIPTION)
    slide = None if text is None else _of_slide(text.data)
    return slide or _of_tags(geo.load(blob)) or _of_tags(described)


def _of_slide(description: bytes) -> Resolution | None:
    microns = slides.microns_per_pixel(description)
    return None if microns is None else _sound((microns, microns), "Aperio MPP")


def _of_tags(entries: dict[int, ifd.Entry]) -> Resolution | None:
    found = density.of_tags(entries)
    if found is None or found.unit not in _MICRONS or found.says_nothing:
        return None
    across, down = found.per(found.unit)
    stated = f"{across:g}" if across == down else f"{across:g} × {down:g}"
    microns = _MICRONS[found.unit]
    return _sound((microns / across, microns / down), f"{stated} pixels per {_PER[found.unit]}")


def _sound(microns: tuple[float, ...], stated: str) -> Resolution | None:
    found: npt.NDArray[np.float64] = np.array(microns)
    return Resolution((microns[0], microns[1]), stated) if np.isfinite(found).all() and (found > 0).all() else None
