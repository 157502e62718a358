"""What of a picture `sgi decode` shows: the region, clipped or padded, and the size, fitted or exact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.options import Sized
from sgicodec.errors import UsageError

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Region, Stream


@dataclass(frozen=True)
class ViewOptions:
    """What the options say. quiet: no warning."""

    region: Region | None
    scale: float | None
    size: Sized | None
    boundless: bool
    quiet: bool

    def __post_init__(self) -> None:
        if self.scale is not None and self.size is not None:
            raise UsageError("--scale and --size exclude each other")
        if self.boundless and self.region is None:
            raise UsageError("--boundless goes with --region")

    def of(self, stream: Stream) -> dict[str, Any]:
        """The arguments of `Stream.picture`. Raises UsageError for a region that lies outside the picture."""
        region = self.region
        if region is not None and not self.boundless:
            region = self._clipped(region, stream.width, stream.height)
        _, _, width, height = region or (0, 0, stream.width, stream.height)
        size = None if self.size is None else fitted(self.size, width, height)
        return {"region": region, "scale": self.scale, "size": size, "boundless": self.boundless}

    def _clipped(self, region: Region, width: int, height: int) -> Region:
        """The part of the region that lies in the picture; a warning if that is not all of it."""
        left, top = max(0, region[0]), max(0, region[1])
        right, bottom = min(width, region[0] + region[2]), min(height, region[1] + region[3])
        found = left, top, right - left, bottom - top
        if found == region or min(found[2:]) < 1:
            return region  # which the stream takes, or refuses
        if not self.quiet:
            asked, taken = (",".join(map(str, numbers)) for numbers in (region, found))
            text = f"region {asked} reaches over the picture of {width}×{height} pixels; it is cut to {taken}"
            click.echo(f"sgi: warning: {text} (--boundless pads)", err=True)
        return found


def fitted(size: Sized, width: int, height: int) -> tuple[int, int]:
    """The largest size of the aspect of `width` × `height` that fits into `size`; `size` itself if it is exact."""
    if size.width is not None and size.height is not None and size.exact:
        return size.width, size.height
    scale = min(side / old for side, old in ((size.width, width), (size.height, height)) if side is not None)
    return max(1, round(width * scale)), max(1, round(height * scale))
