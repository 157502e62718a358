"""Descriptions in which OME, ImageJ and tifffile state the shape of a stack. No single page keeps them: programs would
look for the others. The size of its pixels and the magnification are kept, where they are stated.
"""

from __future__ import annotations

import html
import re
import struct
from collections.abc import Mapping, Sequence
from fractions import Fraction

from sgicodec.metadata import ifd
from sgicodec.metadata.density import Density
from sgicodec.metadata.filebytes import Bytes

_DESCRIPTION, _X, _Y = 270, 282, 283
_ASCII = 2
_CENTIMETRE, _MICRONS = 3, 10000
_MAX_PART = 10**8
"""Of numerator and denominator of a resolution."""

_OME, _IMAGEJ, _SHAPED = (re.compile(form) for form in (rb"OME>\s*\0*\Z", rb"ImageJ=", rb'\{"shape": |shape=\('))
_IMAGES = re.compile(rb"\AImageJ=[^\0]*^images=([0-9]{1,9})$", re.MULTILINE)
_SIZE = re.compile(r'\bPhysicalSize([XY])="([^"]*)"')
_SIZE_UNIT = re.compile(r'\bPhysicalSize[XY]Unit="([^"]*)"')
_POWER = re.compile(r'\bNominalMagnification="([0-9]{1,4}(?:\.[0-9]{1,4})?)"')
_OME_SAYS = re.compile(
    rb"""\b(Color|AcquisitionMode|EmissionWavelength|ExcitationWavelength|Fluor|SignificantBits|PhysicalSizeZ|TimeIncrement
    |DeltaT|ExposureTime|Position[XYZ])=" | <(?:\w+:)?(AcquisitionDate|Description|Detector|Experimenter|Laser
    |Microscope|ROI|StructuredAnnotations)[\s>]""",
    re.VERBOSE,
)
_OME_NAME = re.compile(rb"""SizeC="1".*<(?:\w+:)?Channel\s[^>]*\bName="[^"]""", re.DOTALL)
_IMAGEJ_SAYS, _SHAPED_SAYS = re.compile(rb"^(\w+)=", re.MULTILINE), re.compile(rb'"(\w+)":')
_IDLE = {"ImageJ", "images", "channels", "slices", "frames", "hyperstack", "mode", "loop", "min", "max", "unit"}
_IDLE |= {"shape", "axes", "truncated"}
"""What they say beside the size of pixels; what says nothing of a single page."""
_IMAGEJ_UNIT = re.compile(r"^unit=(.*)$", re.MULTILINE)

_MICRONS_IN = {"µm": Fraction(1), "um": Fraction(1), "micron": Fraction(1), "microns": Fraction(1)}
_MICRONS_IN |= {"nm": Fraction(1, 1000), "mm": Fraction(1000), "cm": Fraction(10000), "m": Fraction(10**6)}
_MICRONS_IN |= {"inch": Fraction(25400), "in": Fraction(25400), "Å": Fraction(1, 10**4), "pm": Fraction(1, 10**6)}


def states_shape(directory: ifd.Directory) -> bool:
    """Whether the description states the shape of a stack."""
    text = _text(directory)
    return bool(_OME.search(text) or _IMAGEJ.match(text) or _SHAPED.match(text))


def images(data: Bytes) -> int:
    """How many images ImageJ says that a TIFF file holds; 1 if it does not."""
    found = _IMAGES.search(_text(ifd.entries(data, {_DESCRIPTION})))
    return int(found[1]) if found else 1


def without_shape(directory: ifd.Directory) -> ifd.Directory:
    """The tags without a description that states the shape of a stack; the size of pixels that it states is now in the
    tags of resolution.
    """
    if not states_shape(directory):
        return directory
    kept: ifd.Directory = {tag: item for tag, item in directory.items() if tag != _DESCRIPTION}
    text, words = _text(directory), html.unescape(_text(directory).decode("utf-8", "replace"))
    if _IMAGEJ.match(text):
        return kept | resolution_tags(_imagej_sizes(words, kept))
    kept |= resolution_tags(_ome_sizes(words))
    power = _POWER.search(words)
    return kept | ({_DESCRIPTION: ifd.Entry(_ASCII, f"AppMag = {power[1]}\0".encode())} if power else {})


def left_behind(directory: Mapping[int, ifd.Entry | ifd.Directory]) -> list[str]:
    """What else a description says that states the shape of a stack, in its own words; nothing of others."""
    text = _text(directory)
    if _OME.search(text):
        whose, words = "OME", [b"".join(pair) for pair in _OME_SAYS.findall(text)]
        words += [b"Channel Name"] * (_OME_NAME.search(text) is not None)
    elif _IMAGEJ.match(text):
        whose, words = "ImageJ", _IMAGEJ_SAYS.findall(text)
    else:
        whose, words = "tifffile", _SHAPED_SAYS.findall(text) if _SHAPED.match(text) else []
    found = [word for word in dict.fromkeys(each.decode("latin-1") for each in words) if word not in _IDLE]
    return [f"{whose}'s {', '.join(found)}"] if found else []


def _text(directory: Mapping[int, ifd.Entry | ifd.Directory]) -> bytes:
    entry = directory.get(_DESCRIPTION)
    return entry.data if isinstance(entry, ifd.Entry) else b""


def resolution_tags(microns: Sequence[str | Fraction | None]) -> dict[int, ifd.Entry]:
    """The tags of a resolution by the size of pixels in x and y, in micrometres; none where it is no sound size."""
    try:
        ratios = [Fraction(_MICRONS) / Fraction(value or "0") for value in microns]
    except (ValueError, ZeroDivisionError):
        return {}
    if len(ratios) != 2 or not all(0 < ratio < _MAX_PART for ratio in ratios):
        return {}
    near = (ratio.limit_denominator(int(_MAX_PART / max(1.0, float(ratio)))) for ratio in ratios)
    across, down = (ratio.as_integer_ratio() for ratio in near)
    return Density(across, down, _CENTIMETRE).tags()


def _ome_sizes(text: str) -> Sequence[Fraction]:
    """Of all pictures in the file, if they have the same."""
    sizes, units = set(_SIZE.findall(text)), set(_SIZE_UNIT.findall(text)) or {"µm"}
    stated = dict(sizes)
    if "X" not in stated or len(sizes) != len(stated) or len(units) != 1:
        return ()
    return _in_microns([str(stated["X"]), str(stated.get("Y", stated["X"]))], units.pop())


def _imagej_sizes(text: str, directory: ifd.Directory) -> Sequence[Fraction]:
    """By the tags of resolution, which count pixels in the unit of the description."""
    unit, values = _IMAGEJ_UNIT.search(text), [directory.get(tag) for tag in (_X, _Y)]
    if unit is None or not all(isinstance(value, ifd.Entry) and len(value.data) == 8 for value in values):
        return ()
    ratios = [struct.unpack("<II", value.data) for value in values if isinstance(value, ifd.Entry)]
    sizes = [f"{below}/{above}" for above, below in ratios]
    return _in_microns(sizes, unit[1].strip().encode("ascii", "backslashreplace").decode("unicode_escape", "replace"))


def _in_microns(sizes: Sequence[str], unit: str) -> Sequence[Fraction]:
    """Sizes in this unit; none of units that are not known, or of what is no number."""
    scale = _MICRONS_IN.get(unit.replace("\u03bc", "µ"))
    try:
        return [Fraction(size) * scale for size in sizes] if scale is not None else ()
    except (ValueError, ZeroDivisionError):
        return ()
