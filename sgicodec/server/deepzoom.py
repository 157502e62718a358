"""Deep Zoom: a picture's description, and its tiles by level, column and row. Each level is half of the next one."""

from __future__ import annotations

from sgicodec.server.drawing import Drawing
from sgicodec.server.refusal import Refusal

MEDIA_TYPE = "application/xml"

_TILE = 512


def description(width: int, height: int, format_: str = "jpg") -> str:
    """What the .dzi file says."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<Image xmlns="http://schemas.microsoft.com/deepzoom/2008" Format="{format_}" Overlap="0" TileSize="{_TILE}">'
        f'<Size Width="{width}" Height="{height}"/></Image>\n'
    )


def tile_drawing(width: int, height: int, level: int, column: int, row: int, format_: str) -> Drawing:
    """The tile of a picture. Level 0 is one pixel, the last one the picture. Raises Refusal where there is none."""
    shrink = max(width - 1, height - 1).bit_length() - level
    if shrink < 0:
        raise Refusal(404, f"there is no level {level}")
    pixels = _TILE << shrink
    x, y = column * pixels, row * pixels
    if x >= width or y >= height:
        raise Refusal(404, f"there is no tile {column}_{row} on level {level}")
    across, down = min(pixels, width - x), min(pixels, height - y)
    return Drawing((x, y, across, down), (-(-across >> shrink), -(-down >> shrink)), format_)
