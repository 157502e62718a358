"""Pages: the pictures of a file that is more than one, such as a stack, a document or an animation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from sgicodec.errors import PictureError, UsageError
from sgicodec.image.library import first_line
from sgicodec.metadata import png
from sgicodec.metadata.ome_planes import ChannelPlanes, channel_planes
from sgicodec.metadata.pages import Page, tiff_pages
from sgicodec.metadata.stacks import images

if TYPE_CHECKING:
    from sgicodec.metadata.filebytes import Bytes

_COUNTED = ("gif", "openexr", "fits")
"""Formats whose further images OpenImageIO shows, each of them a page. Those of others are layers, or the same picture
in another size.
"""


class PageChoice(NamedTuple):
    """A page. subimage: its number to OpenImageIO; pages: how many there are; directory: of a TIFF, where it stands;
    left_out: whether OpenImageIO does not read it, or only what changes in it; channels: the subimages of its channels,
    where each has one of its own, whose names are `names`.
    """

    subimage: int = 0
    pages: int = 1
    directory: Page | None = None
    left_out: bool = False
    channels: tuple[int, ...] = ()
    names: tuple[str, ...] = ()


ONLY = PageChoice()
"""The page of a file that is one."""


def chosen_page(path: Path, data: Bytes, image: Any, page: int | None) -> PageChoice:
    """The page of that number, from 1, of a file that OpenImageIO has opened; the first if None.

    Raises UsageError for one that is not there, PictureError for one that ImageJ wrote without a directory.
    """
    kind = image.format_name()
    if kind == "tiff":
        found = tiff_pages(data) or [Page(0, 0)]
        if len(found) > 1 and not image.seek_subimage(found[-1].number, 0):  # levels of a texture, or damage
            first_line(image)
            found = found[:1]
        planes = channel_planes(data, len(found))
        if planes is not None and len({found[number][2:4] for number in planes.pages[0]}) == 1:
            return _page_of_channels(found, planes, page)
        count = max(len(found), images(data))
        check_page(page, count)
        if (page or 1) > len(found):
            raise PictureError(
                f"its page {page} has no directory of its own, which is not read; save it as a file first"
            )
        directory = found[(page or 1) - 1]
        return PageChoice(directory.number, count, directory)
    count = png.frames(data) if kind == "png" else _counted(path) if kind in _COUNTED else 1
    check_page(page, count)
    is_change = kind in ("png", "gif") and (page or 1) > 1
    return PageChoice(0 if is_change else (page or 1) - 1, count, left_out=is_change)


def _page_of_channels(found: list[Page], planes: ChannelPlanes, page: int | None) -> PageChoice:
    check_page(page, len(planes.pages))
    channels = [found[number] for number in planes.pages[(page or 1) - 1]]
    numbers = tuple(channel.number for channel in channels)
    return PageChoice(channels[0].number, len(planes.pages), channels[0], channels=numbers, names=planes.names)


def _counted(path: Path) -> int:
    """How many images OpenImageIO finds in a file. It may be of no use afterwards to the one that has looked."""
    import OpenImageIO as oiio

    image, count = oiio.ImageInput.open(str(path.absolute())), 1
    while image is not None and image.seek_subimage(count, 0):
        count += 1
    first_line(oiio if image is None else image)  # which clears it
    return count


def check_page(page: int | None, count: int) -> None:
    """Raise UsageError for a page that is none of so many."""
    if page is not None and not (isinstance(page, int) and 1 <= page <= count):
        have = "is one page" if count == 1 else f"has {count} pages, counted from 1"
        raise UsageError(f"there is no page {page}; the picture {have}")
