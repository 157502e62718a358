"""IIIF Image API 3: what the parts of a URL ask for, and what info.json says (https://iiif.io/api/image/3.0/)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sgicodec.server.drawing import FORMATS, MAX_SIDES, QUALITIES, Drawing
from sgicodec.server.refusal import Refusal

CONTEXT = "http://iiif.io/api/image/3/context.json"
LEVEL = "http://iiif.io/api/image/3/level2.json"

TILE = 512
"""Side of the tiles that info.json recommends."""

_REAL_FORMATS = {"gif", "jp2", "pdf"}
"""Formats of the standard that are not rendered."""

_INTEGER, _NUMBER = r"([0-9]{1,99})", r"([0-9]{1,99}(?:\.[0-9]{1,99})?)"
"""Long enough for any, and short enough for a float."""


@dataclass(frozen=True)
class Image:
    """A picture's size, and the most pixels that one answer has."""

    width: int
    height: int
    most: int


def read_drawing(image: Image, region: str, size: str, rotation: str, quality: str, format_: str) -> Drawing:
    """What the parts of a URL ask for. Raises Refusal: 400 for nonsense, 501 for what the standard has and this server
    has not.
    """
    if format_ not in FORMATS:
        raise Refusal(
            501 if format_ in _REAL_FORMATS else 400, f"the format {format_!r} is not one of {_list(FORMATS)}"
        )
    if quality not in QUALITIES:
        raise Refusal(400, f"the quality {quality!r} is not one of {_list(QUALITIES)}")
    degrees, mirror = _rotation(rotation)
    cut = _region(image, region)
    width, height = _size(image, cut, size)
    if max(width, height) > MAX_SIDES.get(format_, math.inf):
        raise Refusal(400, f"{format_} has sides of at most {MAX_SIDES[format_]} pixels, not {width}×{height}")
    return Drawing(cut, (width, height), format_, degrees, mirror, quality)


def canonical(image: Image, drawing: Drawing) -> str:
    """The parts of the URL of a drawing, as every server writes them."""
    x, y, width, height = drawing.region
    region = "full" if drawing.region == (0, 0, image.width, image.height) else f"{x},{y},{width},{height}"
    enlarged = drawing.size[0] > width or drawing.size[1] > height
    size = "max" if drawing.size == (width, height) else "^" * enlarged + "{},{}".format(*drawing.size)
    return f"{region}/{size}/{'!' * drawing.mirror}{drawing.rotation}/{drawing.quality}.{drawing.format}"


def info(image: Image, address: str, levels: list[tuple[int, int]]) -> dict[str, Any]:
    """info.json of the picture at this address. levels: sizes of its pyramid, the largest first."""
    sizes = [{"width": w, "height": h} for w, h in reversed(levels) if w * h <= image.most]
    return {
        "@context": CONTEXT,
        "id": address,
        "type": "ImageService3",
        "protocol": "http://iiif.io/api/image",
        "profile": "level2",
        "width": image.width,
        "height": image.height,
        "maxArea": image.most,
        "sizes": sizes,
        "tiles": [{"width": TILE, "height": TILE, "scaleFactors": [2**level for level in range(len(levels))]}],
        "preferredFormats": ["jpg", "webp", "png"],
        "extraFormats": ["webp", "tif"],
        "extraQualities": ["color", "gray", "bitonal"],
        "extraFeatures": ["mirroring", "sizeUpscaling", "canonicalLinkHeader", "profileLinkHeader"],
    }


def manifest(image: Image, address: str, title: str) -> dict[str, Any]:
    """The manifest (IIIF Presentation API 3) of a work whose only page is the picture at this address."""
    scale = min(1.0, 1024 / max(image.width, image.height))
    width, height = max(1, round(image.width * scale)), max(1, round(image.height * scale))
    body = {
        "id": f"{address}/full/{width},{height}/0/default.jpg",
        "type": "Image",
        "format": "image/jpeg",
        "width": width,
        "height": height,
        "service": [{"id": address, "type": "ImageService3", "profile": "level2"}],
    }
    page = f"{address}/canvas"
    painting = {
        "id": f"{page}/page/image",
        "type": "Annotation",
        "motivation": "painting",
        "target": page,
        "body": body,
    }
    canvas = {
        "id": page,
        "type": "Canvas",
        "width": image.width,
        "height": image.height,
        "items": [{"id": f"{page}/page", "type": "AnnotationPage", "items": [painting]}],
    }
    return {
        "@context": "http://iiif.io/api/presentation/3/context.json",
        "id": f"{address}/manifest.json",
        "type": "Manifest",
        "label": {"none": [title]},
        "items": [canvas],
    }


def _rotation(text: str) -> tuple[int, bool]:
    found = re.fullmatch(rf"(!?){_NUMBER}", text)
    degrees = float(found[2]) if found else math.inf
    if found is None or degrees > 360:
        raise Refusal(400, f"the rotation {text!r} is not a number of degrees from 0 to 360")
    if degrees % 90:
        raise Refusal(501, "a rotation must be 0, 90, 180 or 270 degrees here")
    return int(degrees) % 360, bool(found[1])


def _region(image: Image, text: str) -> tuple[int, int, int, int]:
    x, y, width, height = _asked(image, text)
    if not (width and height):
        raise Refusal(400, f"the region {text!r} has no pixels")
    if x >= image.width or y >= image.height:
        raise Refusal(400, f"the region {text!r} is not in the picture of {image.width}×{image.height} pixels")
    return x, y, min(width, image.width - x), min(height, image.height - y)


def _asked(image: Image, text: str) -> tuple[int, ...]:
    """x, y, width, height, which may reach over the picture."""
    if text == "full":
        return 0, 0, image.width, image.height
    if text == "square":
        side = min(image.width, image.height)
        return (image.width - side) // 2, (image.height - side) // 2, side, side
    if found := re.fullmatch(",".join([_INTEGER] * 4), text):
        return tuple(map(int, found.groups()))
    if found := re.fullmatch("pct:" + ",".join([_NUMBER] * 4), text):
        sides = (image.width, image.height) * 2
        return tuple(round(side * float(part) / 100) for side, part in zip(sides, found.groups(), strict=True))
    raise Refusal(400, f"the region {text!r} is not full, square, x,y,w,h or pct:x,y,w,h")


def _size(image: Image, region: tuple[int, int, int, int], text: str) -> tuple[int, int]:
    upscale, form = text.startswith("^"), text.removeprefix("^")
    _, _, across, down = region
    most = _fitted(across, down, math.sqrt(image.most / (across * down)))  # by the server's limit
    if form == "max":
        width, height = most if upscale or across * down > image.most else (across, down)
        return width, height
    for pattern, reading in _SIZES.items():
        if found := re.fullmatch(pattern, form):
            width, height = reading(across, down, *map(float, found.groups()))
            break
    else:
        raise Refusal(400, f"the size {text!r} is not max, w,h w, ,h pct:n or !w,h, with or without ^")
    if form.startswith("!"):
        limits = [(width, height), most] if upscale else [(width, height), most, (across, down)]
        width, height = min(limits)
    if not (width and height):
        raise Refusal(400, f"the size {text!r} has no pixels")
    if not upscale and (width > across or height > down):
        raise Refusal(400, f"{width}×{height} pixels are more than the region's {across}×{down}; write ^{text}")
    if width * height > image.most:
        raise Refusal(400, f"{width}×{height} pixels are more than this server draws at once, {image.most}")
    return width, height


def _fitted(across: int, down: int, scale: float) -> tuple[int, int]:
    """The largest size in whole pixels at this scale, at least one pixel each way."""
    return max(1, int(across * scale)), max(1, int(down * scale))


_Reading = Callable[..., tuple[int, int]]

_SIZES: dict[str, _Reading] = {
    f"{_INTEGER},{_INTEGER}": lambda across, down, w, h: (int(w), int(h)),
    f"{_INTEGER},": lambda across, down, w: (int(w), max(1, round(down * w / across)) if w else 0),
    f",{_INTEGER}": lambda across, down, h: (max(1, round(across * h / down)) if h else 0, int(h)),
    f"pct:{_NUMBER}": lambda across, down, n: (round(across * n / 100), round(down * n / 100)),
    f"!{_INTEGER},{_INTEGER}": lambda across, down, w, h: _inside(across, down, w, h),
}
"""Forms of a size, and what they make of the region's width and height."""


def _inside(across: int, down: int, width: float, height: float) -> tuple[int, int]:
    """The largest size of the same aspect in width × height."""
    if not (width and height):
        return 0, 0
    if width * down <= height * across:
        return int(width), max(1, round(down * width / across))
    return max(1, round(across * height / down)), int(height)


def _list(names: Any) -> str:
    return ", ".join(names)
