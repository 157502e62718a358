"""Reading parts of a picture that need not fit into memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, UsageError
from sgicodec.image.access import KeptRows, Tiles, access
from sgicodec.image.header import MAX_SAMPLES, Probe, renumbered
from sgicodec.image.jpeg2000_reader import Jpeg2000Reader
from sgicodec.image.opened import Alpha, Opened, open_picture
from sgicodec.image.origin import Origin, naming, on_disk
from sgicodec.image.reader import check_whole, pictured
from sgicodec.image.used_range import RangeChoice, SampleUse, UsedRange, stated_use
from sgicodec.metadata.layouts import SampleRange, alpha_index
from sgicodec.metadata.orientation import Window, stored_window
from sgicodec.picture import Metadata, Picture

_SCAN_SAMPLES = 1 << 22
"""Samples of a window by which the range in use is looked for."""

NO_OPACITY = "what is declared as alpha is opaque nowhere, or more than that: it is coded as a band like the others"


LIGHT = "colours where alpha is 0, as of light, come back with --lossless or --max-error alone"
ALPHA_IS_BAND = "alpha is coded as a band like the others, which are not gray or RGB alone"


class Source:
    """An open picture, one image of a file, of bytes, or of a stream from where it stands: what it is at once, its
    pixels window by window. A context manager; not for several threads.

    max_samples caps what is held in memory at once, not the picture. sample_range, alpha and page are as in `read`; a
    SampleUse is what another one found. keeps: rows of a picture of up to 128 MiB stay in memory once they were read,
    for who reads it more than once. Raises PictureError as `read` does for all that the header says.

    The pixels are those that `read` gives, bit for bit. What is damaged, or not a number, is found in the window that
    it is in. path: of the file, or of a copy that lasts as long as this is open. page: that was asked for, or None.
    """

    def __init__(
        self,
        origin: Origin,
        *,
        max_samples: int = MAX_SAMPLES,
        sample_range: RangeChoice | SampleUse | None = None,
        alpha: Alpha = "auto",
        page: int | None = None,
        keeps: bool = False,
    ) -> None:
        self._origin, self._max_samples, self._alpha, self.page = origin, max_samples, alpha, page
        self._use = sample_range if isinstance(sample_range, SampleUse) else None
        self._is_scanned = False
        with naming(origin), ExitStack() as stack:
            self.path = stack.enter_context(on_disk(origin))
            self._state = _state_of(self.path)
            self._opened: Opened = open_picture(self.path, any_size=True, alpha=alpha, page=page)
            stack.callback(lambda: self._opened.image.close())
            self._access = access(self._opened, keeps)
            if self._opened.in_library or isinstance(self._access, KeptRows):
                check_whole(self._opened, max_samples)
            self._check(1, 1)
            if not isinstance(sample_range, SampleUse):
                self._use = stated_use(sample_range, self.dtype, self._colours)
            self._stack = stack.pop_all()

    def __enter__(self) -> Source:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; no window can be read any more."""
        self._stack.close()

    def check_unchanged(self) -> None:
        """Raises PictureError if the file is another one than when it was opened: windows may be of either."""
        with naming(self._origin):
            if _state_of(self.path) not in (None, self._state):
                raise PictureError("the file has changed since it was opened; encode it again")

    @property
    def pages(self) -> int:
        """How many pages the file has."""
        return self._opened.page.pages

    @property
    def is_associated(self) -> bool:
        """Whether its colours are stored multiplied by alpha, so that alpha is opacity."""
        return self._opened.associated

    @property
    def alpha_may_be_band(self) -> bool:
        """Whether what the file declares as alpha may be near infrared: a TIFF or JPEG 2000 of unassociated alpha."""
        declared = self._alpha == "auto" and alpha_index(self.channels) is not None and not self.is_associated
        return declared and self._opened.kind in ("tiff", "jpeg2000", Jpeg2000Reader.kind)

    @property
    def notes(self) -> tuple[str, ...]:
        """What of the page, and of what the file says, does not come as it is."""
        opened = self._opened
        notes = [*getattr(opened.image, "notes", ())]
        if opened.native not in (self.dtype, np.float16):
            rounded = "" if np.can_cast(opened.native, self.dtype) else ", rounded to 24 bits"
            notes.append(f"samples of {opened.native} become 32-bit floats{rounded}")
        if numbers := renumbered(opened.spec, opened.kind, opened.channels.largest):
            notes.append(numbers)
        if opened.alpha_is_band and self._alpha != "band":
            notes.append(ALPHA_IS_BAND)
        if left := opened.left_behind():
            notes.append(f"not kept: {', '.join(left)}")
        return tuple(notes)

    @property
    def header(self) -> Probe:
        """Size, layout, channel count and sample type of the upright picture."""
        return self._opened.header

    @property
    def width(self) -> int:
        """Columns."""
        return self.header.width

    @property
    def height(self) -> int:
        """Rows."""
        return self.header.height

    @property
    def channels(self) -> str:
        """A layout, as in `Picture`."""
        return self.header.channels

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of samples: uint8, uint16 or float32."""
        return self.header.dtype

    @property
    def metadata(self) -> Metadata:
        """That of the upright picture."""
        return self._opened.metadata

    @property
    def nodata(self) -> float | None:
        """The sample value that stands for "nothing was measured here", or None. It may be not-a-number."""
        declared = self._opened.nodata
        return self.use.blank if declared is None else declared

    @property
    def sample_range(self) -> SampleRange:
        """As in `Picture`."""
        return self.use.sample_range

    @property
    def use(self) -> SampleUse:
        """What samples are. For the range in use all pixels are read, once, on first use.

        Raises PictureError for samples that no range does justice to.
        """
        if self._use is None:
            found = UsedRange(self.channels, self._colours, self.dtype, self._opened.nodata)
            with naming(self._origin):
                for window in self._scan():
                    found.add(self._pixels(window))
                use = found.found()
                remark = "; ".join(filter(None, (use.remark, LIGHT if self._opened.shines else None)))
                self._use = replace(use, remark=remark or None)
        return self._use

    @property
    def rounding(self) -> float:
        """As in `Picture`. All pixels are read, once, where there may be any."""
        is_divided = self.is_associated and self.dtype != np.float32
        may_be_off = is_divided or not np.can_cast(self._opened.native, self.dtype)
        if not self._is_scanned and may_be_off:
            with naming(self._origin):
                for window in self._scan():
                    self._pixels(window)
        return self._opened.rounding

    @property
    def _colours(self) -> int:
        return self.header.count - (alpha_index(self.channels) is not None)

    def read(self, x: int, y: int, width: int, height: int) -> Picture:
        """The picture of a window whose first pixel is (x, y); its metadata are the whole picture's.

        Ask in rows of windows from the top down: most formats can only go forward. Raises PictureError for damage and
        for windows beyond the cap of samples, UsageError for those not inside the picture.
        """
        if not (0 <= x < x + width <= self.width and 0 <= y < y + height <= self.height):
            raise UsageError(
                f"window {x},{y},{width},{height} is not inside the picture of {self.width}×{self.height} pixels"
            )
        with naming(self._origin):
            pixels = self._pixels((x, y, width, height))
            return pictured(pixels, self.channels, self.use, self._opened.nodata, self.metadata)

    def memory(self, width: int, height: int) -> int:
        """Bytes that reading windows of width × height pixels one after the other takes at most, the window included.

        Not counted are what a window shares with the next row of windows, and what libraries hold of interlaced PNG
        (all samples), progressive JPEG (two bytes for each) and compressed strips of TIFF (one strip).
        """
        header, native = self.header, self._opened.native.itemsize
        library = self._opened.in_library * header.width * header.height * header.count * native
        copies = 2 * width * height * header.count * header.dtype.itemsize
        return self._held(width, height) * native + copies + library

    def _pixels(self, window: Window) -> npt.NDArray[Any]:
        self._check(*window[2:])
        stored = self._access.read(*stored_window(window, self.width, self.height, self._opened.orientation))
        return self._opened.finished(stored)

    def _held(self, width: int, height: int) -> int:
        *_, stored_width, stored_height = stored_window((0, 0, width, height), 0, 0, self._opened.orientation)
        return self._access.held(stored_width, stored_height)

    def _check(self, width: int, height: int) -> None:
        """Raise PictureError if such windows need more samples than may be held."""
        held = self._held(width, height)
        if held > self._max_samples:
            raise PictureError(
                f"a window of {width} × {height} pixels takes {held} samples in memory, more than the cap of "
                f"{self._max_samples}"
            )

    def _scan(self) -> Iterator[Window]:
        """Windows that cover the picture: squares of tiles, or full rows."""
        self._is_scanned = True
        side = int((_SCAN_SAMPLES / self.header.count) ** 0.5) + 1
        columns = side if isinstance(self._access, Tiles) else self.width
        rows = max(1, _SCAN_SAMPLES // (columns * self.header.count))
        for y in range(0, self.height, rows):
            for x in range(0, self.width, columns):
                yield x, y, min(columns, self.width - x), min(rows, self.height - y)


def _state_of(path: Path) -> tuple[int, ...] | None:
    """What tells a file from another one of its name, or from itself before it was changed; None where it is gone."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns


open_source = Source


def open_to_encode(
    origin: Origin,
    note: Callable[[str], None],
    *,
    sample_range: RangeChoice | None = None,
    alpha: Alpha = "auto",
    page: int | None = None,
    option: str = "page",
    keeps: bool = True,
) -> Source:
    """The same for an encode, with `note` called for what its owner should know. Where samples of 16 bits or floats
    that TIFF or JPEG 2000 declares as alpha cannot be opacity, they are a band like the others. option: what chooses a
    page; keeps: as in `open_source`.
    """
    if not isinstance(origin, str | Path | bytes):
        origin = origin.read()
    source = open_source(origin, sample_range=sample_range, alpha=alpha, page=page, keeps=keeps)
    try:
        if source.alpha_may_be_band and not source.use.opacity:
            source.close()
            source = open_source(origin, sample_range=sample_range, alpha="band", page=page, keeps=keeps)
            note(NO_OPACITY)
        if page is None and source.pages > 1:
            note(f"the first of {source.pages} pages; {option} chooses another")
        for text in source.notes:
            note(text)
    except BaseException:
        source.close()
        raise
    return source
