"""XMP packets that follow their picture: turned upright, and what a view shows of it (XMP parts 1 and 2).

Properties are found in the text by the prefixes that it declares. Nothing else is changed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import partial

from sgicodec.metadata.motion import Motion

_TIFF = ("tiff", b"http://ns.adobe.com/tiff/1.0/")
_EXIF = ("exif", b"http://ns.adobe.com/exif/1.0/")
_GPANO = ("GPano", b"http://ns.google.com/photos/1.0/panorama/")
_MWG = ("mwg-rs", b"http://www.metadataworkinggroup.com/schemas/regions/")
_MP = ("MP", b"http://ns.microsoft.com/photo/1.2/")
_IPTC = ("Iptc4xmpExt", b"http://iptc.org/std/Iptc4xmpExt/2008-02-29/")
_DIMENSIONS = ("stDim", b"http://ns.adobe.com/xap/1.0/sType/Dimensions#")

_GAIN_MAPS = (
    ("hdrgm", b"http://ns.adobe.com/hdr-gain-map/1.0/"),
    ("HDRGainMap", b"http://ns.apple.com/HDRGainMap/1.0/"),
)
_CONTAINER = ("Container", b"http://ns.google.com/photos/1.0/container/")
_CAMERA = ("GCamera", b"http://ns.google.com/photos/1.0/camera/")
_VIDEO = tuple(
    f"{kind}{name}"
    for kind in ("MotionPhoto", "MicroVideo")
    for name in ("", "Version", "Offset", "PresentationTimestampUs")
)

_SIZES = ((_TIFF, "ImageWidth", "ImageLength"), (_EXIF, "PixelXDimension", "PixelYDimension"))
_RATIOS = (
    (_TIFF, "XResolution", "YResolution"),
    (_EXIF, "FocalPlaneXResolution", "FocalPlaneYResolution"),
)
_AREAS = ("SubjectArea", "SubjectLocation")
_REGIONS = ((_MWG, "Regions"), (_MP, "RegionInfo"), (_IPTC, "ImageRegion"))
"""Faces and other places, as shares of the picture."""

_FULL = ("FullPanoWidthPixels", "FullPanoHeightPixels")
_CROP = ("CroppedAreaImageWidthPixels", "CroppedAreaImageHeightPixels")
_CORNER = ("CroppedAreaLeftPixels", "CroppedAreaTopPixels")
_INNER = tuple(f"LargestValidInteriorRect{side}" for side in ("Left", "Top", "Width", "Height"))

_PIXELS = re.compile(rb"""rbUnit(?:\s*=\s*["']|\s*>\s*)pixel""")
"""The unit of a region of IPTC; else it is relative."""

_MAX_PREFIXES = 8
"""Names of a schema in one packet; nobody gives it several but to cost time."""

Schema = tuple[str, bytes]
Change = Callable[[bytes], bytes | None]


def orientation(packet: bytes | None) -> int | None:
    """The orientation that the packet states, 1 to 8, or None."""
    value = None if packet is None else _Packet(packet).integer(_TIFF, "Orientation")
    return value if value in range(1, 9) else None


def upright(packet: bytes) -> bytes:
    """The packet with its copy of the orientation, which some readers obey, set to 1, and without what makes readers
    look for a gain map or a video behind the picture.
    """
    found = _Packet(packet)
    if found.integer(_TIFF, "Orientation") in range(2, 9):
        found.set(_TIFF, "Orientation", 1)
    for schema in _GAIN_MAPS:
        if schema[1] in packet:
            found.remove_all(schema)
    found.set(_CONTAINER, "Directory", None)
    for name in _VIDEO:
        found.set(_CAMERA, name, None)
    return found.text


def moved(packet: bytes, motion: Motion) -> bytes:
    """The packet of a picture whose pixels moved: sizes, pixels per unit and places that it states are changed; those
    that cannot be are taken out.
    """
    found = _Packet(packet)
    if motion.is_none:
        return packet
    for schema, across, down in _SIZES:
        width, height = found.integer(schema, across), found.integer(schema, down)
        new = motion.size_of_all(width or motion.width, height or motion.height)
        found.set(schema, across, new[0])
        found.set(schema, down, new[1])
    for schema, across, down in _RATIOS:
        _move_ratios(found, schema, across, down, motion)
    for name in _AREAS:
        found.change(_EXIF, name, lambda text: _moved_list(text, motion))
    _move_panorama(found, motion)
    is_scaled = motion.is_whole and not motion.is_turned
    for schema, name in _REGIONS:
        found.change(schema, name, partial(_rescaled, packet=packet, motion=motion) if is_scaled else _nothing)
    return found.text


def _move_ratios(found: _Packet, schema: Schema, across: str, down: str, motion: Motion) -> None:
    old = [_fraction(found.value(schema, name)) for name in (across, down)]
    if motion.is_sideways and None in old:
        found.set(schema, across, None)
        found.set(schema, down, None)
        return
    new = motion.ratios(old[0] or (0, 0), old[1] or (0, 0))
    for name, before, ratio in zip((across, down), old, new, strict=True):
        if before != ratio:
            found.set(schema, name, None if before is None else "{}/{}".format(*ratio))


def _fraction(text: bytes | None) -> tuple[int, int] | None:
    found = None if text is None else re.fullmatch(rb"\s*(\d{1,10})(?:/(\d{1,10}))?\s*", text)
    return None if found is None else (int(found[1]), int(found[2] or 1))


def _moved_list(text: bytes, motion: Motion) -> bytes | None:
    """A list of the numbers of an area, which are the only digits between its tags."""
    numbers = list(re.finditer(rb"(?<=>)\s*(\d{1,9})\s*(?=</)", text))
    values = motion.area([int(number[1]) for number in numbers])
    if values is None:
        return None
    for number, value in reversed(list(zip(numbers, values, strict=True))):
        text = text[: number.start()] + str(value).encode("ascii") + text[number.end() :]
    return text


def _nothing(_: bytes) -> None:
    return None


def _rescaled(text: bytes, packet: bytes, motion: Motion) -> bytes | None:
    """Regions as shares of the picture, with the size of it that they were made for; those in pixels are taken out."""
    if _PIXELS.search(text):
        return None
    found = _Packet(text, packet)
    new = motion.size_of_all(0, 0)
    found.set(_DIMENSIONS, "w", new[0])
    found.set(_DIMENSIONS, "h", new[1])
    return found.text


def _move_panorama(found: _Packet, motion: Motion) -> None:
    """Google's photo sphere: a region of it is a crop of the full panorama. One that was turned is none any more."""
    names: tuple[str, ...] = (*_FULL, *_CROP, *_CORNER)
    values = [found.integer(_GPANO, name) for name in names]
    if motion.is_turned or (not motion.is_whole and None in values):
        found.remove_all(_GPANO)
        return
    sizes = (*_sized(values[:2], motion), *motion.size_of_all(0, 0), *_sized(values[4:], motion, motion.x, motion.y))
    inner = [found.integer(_GPANO, name) for name in _INNER]
    if motion.is_whole:
        names, sizes = (*names, *_INNER), (*sizes, *_sized(inner[:2], motion), *_sized(inner[2:], motion))
    else:
        for name in _INNER:
            found.set(_GPANO, name, None)
    for name, size in zip(names, sizes, strict=True):
        found.set(_GPANO, name, size)


def _sized(pair: list[int | None], motion: Motion, x: float = 0.0, y: float = 0.0) -> tuple[int | None, ...]:
    """A size, or a distance from x and y, in new pixels."""
    across = None if pair[0] is None else round((pair[0] + x) * motion.scale_x)
    down = None if pair[1] is None else round((pair[1] + y) * motion.scale_y)
    return across, down


class _Packet:
    """A text in which properties are found, as attributes or as elements, and changed."""

    def __init__(self, text: bytes, declared: bytes | None = None) -> None:
        """declared: what declares the prefixes, if not the text itself."""
        self.text, self._declared = text, text if declared is None else declared

    def _names(self, schema: Schema, name: str) -> bytes:
        """A pattern of the names of a property."""
        usual, address = schema
        found = re.findall(rb"""xmlns:([\w.-]{1,40})\s*=\s*["']%b["']""" % re.escape(address), self._declared)
        prefixes = sorted({re.escape(prefix) for prefix in (*found[:_MAX_PREFIXES], usual.encode("ascii"))})
        return rb"(?:%b):%b" % (b"|".join(prefixes), name.encode("ascii"))

    def value(self, schema: Schema, name: str) -> bytes | None:
        """The first value of a property without parts."""
        if b":" + name.encode("ascii") not in self.text:
            return None
        names = self._names(schema, name)
        found = re.search(
            rb"""(?<=\s)%b\s*=\s*(?:"([^"<]*)"|'([^'<]*)')|<%b(?:\s[^<>]*)?>([^<]*)</""" % (names, names), self.text
        )
        return None if found is None else next(group for group in found.groups() if group is not None)

    def integer(self, schema: Schema, name: str) -> int | None:
        """The same as an integer; None for others."""
        found = re.fullmatch(rb"\s*(\d{1,10})\s*", self.value(schema, name) or b"")
        return None if found is None else int(found[1])

    def set(self, schema: Schema, name: str, value: int | str | None) -> None:
        """Give the property, where it stands, this value; None takes it out."""
        self.change(schema, name, lambda _: None if value is None else str(value).encode("ascii"))

    def remove_all(self, schema: Schema) -> None:
        """Take out all properties of a schema, none of which holds others."""
        self._change(self._names(schema, r"[\w.-]{1,60}"), _nothing)

    def change(self, schema: Schema, name: str, change: Change) -> None:
        """Put what `change` makes of the property's text in its place; None takes it out."""
        if b":" + name.encode("ascii") in self.text:
            self._change(self._names(schema, name), change)

    def _change(self, names: bytes, change: Change) -> None:
        def attribute(found: re.Match[bytes]) -> bytes:
            new = change(found[3])
            return b"" if new is None else found[1] + found[2] + new + found[2]

        self.text = re.sub(rb"""(?<=\s)(%b\s*=\s*)(["'])([^"'<>]*)\2""" % names, attribute, self.text)
        kept, at = bytearray(), 0
        for start, end in self._elements(names):
            new = None if end is start else change(self.text[start.end() : end.start()])
            kept += self.text[at : start.start()]
            kept += b"" if new is None else start[0] + new + end[0]
            at = end.end()
        self.text = bytes(kept) + self.text[at:]

    def _elements(self, names: bytes) -> Iterator[tuple[re.Match[bytes], re.Match[bytes]]]:
        """Start and end tag of each element; the same for one without contents."""
        last = re.compile(rb"</%b\s*>" % names)
        stop = 0
        for start in re.finditer(rb"<%b(?:\s[^<>]*)?/?>" % names, self.text):
            if start.start() < stop:
                continue
            end = start if start[0].endswith(b"/>") else last.search(self.text, start.end())
            if end is None:
                return
            yield start, end
            stop = end.end()
