"""A picture read window by window, whether it is in memory or in a file; alpha that says nothing is left out."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from sgicodec.encoder.plan import Plan, Shape, stream_plan
from sgicodec.errors import UsageError
from sgicodec.metadata import geo
from sgicodec.metadata.layouts import WITHOUT_ALPHA, alpha_index
from sgicodec.model.tile_grid import Rect, TileGrid
from sgicodec.picture import Picture, opaque_mask

if TYPE_CHECKING:
    from sgicodec.encoder.progress import NullListener
    from sgicodec.image.source import Source

_BLOCK = 1 << 20


@dataclass(frozen=True)
class Windows:
    """What an encode asks of a picture. Windows are asked for in rows, from the top down."""

    shape: Shape
    """What it is."""
    read: Callable[[int, int, int, int], Picture]
    """The pixels of a window: x and y of its first pixel, width, height. Raises PictureError."""
    memory: Callable[[int, int], int]
    """Bytes that reading windows of this width and height takes at most."""
    digest: Callable[[], bytes]
    """32 bytes that change with any pixel."""
    page: int | None = None
    """Which page of its file it is, where that was asked for."""

    def seen(self, look: Callable[[Picture, Rect], Picture], **changes: Any) -> Windows:
        """The same picture as `look` shows each window of it. changes: of its shape."""

        def read(x: int, y: int, width: int, height: int) -> Picture:
            return look(self.read(x, y, width, height), (x, y, width, height))

        return replace(self, read=read, shape=replace(self.shape, **changes))


def windows_of(picture: Picture | Source) -> Windows:
    """The windows of a picture in memory, or of an opened one, all of whose samples are read once more where their
    range is not known. Raises UsageError for what is neither.
    """
    if isinstance(picture, Picture):
        return Windows(Shape.of(picture), partial(_part, picture), lambda *_: 0, partial(_digest_of_pixels, picture))
    if not hasattr(picture, "header"):
        raise UsageError(f"{type(picture).__name__} is no Picture, nor opened by open_source; encode takes arrays")
    source, use = picture, picture.use
    shape = Shape(
        source.width,
        source.height,
        source.channels,
        source.header.count,
        source.dtype,
        use.sample_range,
        source.metadata,
        source.nodata,
        use.exact,
        use.eight_bits,
        use.remark,
        source.rounding,
    )
    return Windows(shape, source.read, source.memory, partial(_digest_of_file, source), source.page)


def tile_window(windows: Windows, plan: Plan, number: int) -> Picture:
    """What a tile covers."""
    return plan.of_header(windows.read(*plan.header.grid.rect(number)))


def kept(windows: Windows) -> Windows:
    """The same, read whole when a window is first asked for, and then kept."""
    whole = cache(lambda: windows.read(0, 0, windows.shape.width, windows.shape.height))
    return replace(windows, read=lambda *rect: _part(whole(), *rect))


def _part(picture: Picture, x: int, y: int, width: int, height: int) -> Picture:
    return replace(picture, pixels=picture.pixels[y : y + height, x : x + width])


def _digest_of_pixels(picture: Picture) -> bytes:
    digest = hashlib.sha256()
    for row in picture.pixels:
        digest.update(row.tobytes())
    return digest.digest()


def _digest_of_file(source: Source) -> bytes:
    digest = hashlib.sha256(b"" if source.page is None else b"page %d" % source.page)
    path = Path(source.path)
    for part in sorted(filter(Path.is_file, path.rglob("*"))) if path.is_dir() else [path]:
        digest.update(part.relative_to(path).as_posix().encode() if part != path else b"")
        with part.open("rb") as file:
            while block := file.read(_BLOCK):
                digest.update(block)
    return digest.digest()


def without_needless_alpha(windows: Windows, plan: Plan, listener: NullListener) -> tuple[Windows, Plan]:
    """A picture and its plan without an alpha that says nothing. The listener gets to know, also of what an alpha that
    stays may mean.
    """
    if alpha_index(plan.header.channels) is None:
        return windows, plan
    alpha = _everywhere(windows, plan.header.grid)
    if alpha == "opaque":
        listener.remark("alpha is opaque everywhere; it is left out")
    elif alpha == "hiding" and plan.header.masked == "transparent":
        listener.note("alpha is 0 everywhere; it is left out, and the colours are kept")
    else:
        _note_alpha(windows, plan, listener)
        return windows, plan
    channels = WITHOUT_ALPHA[windows.shape.channels]
    windows = windows.seen(
        lambda picture, _: replace(picture, pixels=picture.pixels[..., :-1], channels=channels),
        channels=channels,
        bands=windows.shape.bands - 1,
    )
    return windows, stream_plan(windows.shape, plan.settings)


def _note_alpha(windows: Windows, plan: Plan, listener: NullListener) -> None:
    masked = plan.header.masked
    if geo.has_place(windows.shape.metadata.geo):
        listener.note(_BAND_AS_ALPHA + (_NOT_KEPT if masked == "transparent" else ""))
    if masked == "nodata" and plan.settings.max_error is None:
        listener.note(_ALPHA_AND_NODATA)


_BAND_AS_ALPHA = (
    "the last band is declared as alpha; if it is a band like the others, such as near infrared, read it with alpha as "
    "a band (--alpha band)"
)
_NOT_KEPT = ": where it is 0, the others are not kept"
_ALPHA_AND_NODATA = (
    "there is a nodata value besides alpha: alpha is lossy, also where it is 0; --lossless and --max-error keep it"
)


def _everywhere(windows: Windows, grid: TileGrid) -> Literal["opaque", "hiding"] | None:
    """What alpha is in every pixel of a picture that has alpha: "opaque", or "hiding" colours that are there; None
    where it differs. No more is read than it takes to tell.
    """
    opaque = hiding = True
    colours = False
    for number in range(grid.count):
        picture = windows.read(*grid.core(number))
        pixels = picture.pixels
        opaque, hiding = opaque and bool(opaque_mask(picture).all()), hiding and not pixels[..., -1].any()
        if not (opaque or hiding):
            return None
        colours = colours or bool(pixels[..., :-1].any())
    if opaque:
        return "opaque"
    return "hiding" if colours else None
