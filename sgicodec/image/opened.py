"""A picture file that OpenImageIO has opened: its header and metadata in our terms, its samples on demand."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from sgicodec.arrays import Samples
from sgicodec.errors import MissingExtraError, PictureError, UsageError
from sgicodec.image.alpha import is_clipped, unassociate
from sgicodec.image.avif_reader import AvifReader
from sgicodec.image.beside import files_beside
from sgicodec.image.channels import AsIs, Channels, Last, declared_channels
from sgicodec.image.decoded_picture import DecodedPicture, Reader
from sgicodec.image.gdal_place import place_by_gdal
from sgicodec.image.header import (
    ALREADY_UPRIGHT,
    Probe,
    band_colours,
    bits_shifted,
    has_own_numbers,
    header,
    holds_shifted_uint16,
    is_associated,
    is_white_zero,
    number_as_read,
    orientation,
)
from sgicodec.image.header_words import not_kept
from sgicodec.image.heif_reader import HeifReader
from sgicodec.image.library import load_openimageio
from sgicodec.image.narrowed import narrowed
from sgicodec.image.opening import by_others, complaint, is_openimageio, no_size_limit, open_image, unread_floats
from sgicodec.image.pages import ONLY, PageChoice, check_page, chosen_page
from sgicodec.image.planes import Planes
from sgicodec.image.raw_reader import RawReader
from sgicodec.image.silence import without_libpng
from sgicodec.image.slide_reader import SlideReader, is_slide
from sgicodec.image.sniffed import SniffedFormat, larger_below, others_below, sniffed_format
from sgicodec.image.zarr_reader import ZarrReader, is_zarr
from sgicodec.metadata import embedded, geo, icc, ifd, jp2, placement, png, radiance
from sgicodec.metadata.filebytes import FileBytes
from sgicodec.metadata.gdal_items import stated_of_samples, with_colours
from sgicodec.metadata.layouts import alpha_index
from sgicodec.metadata.left_behind import left_behind
from sgicodec.metadata.orientation import upright
from sgicodec.metadata.pages import PageBytes
from sgicodec.picture import Metadata

if TYPE_CHECKING:
    from OpenImageIO import ImageInput, ImageSpec


_STREAM_SIGNATURE = b"\x89SGI\r\n\x1a\n"
Alpha = Literal["auto", "band", "none"]
_LAST: dict[str, Last] = {"band": "band", "none": "unused"}
_IN_LIBRARY = {"gif": 1, "iff": 1, "jpeg2000": 5, "jpegxl": 6, "pnm": 1, "targa": 1, "webp": 3}
"""Formats that OpenImageIO's own readers hold whole, and how many times the size of samples that takes."""
_NUMPY_NAMES = {"half": "float16", "float": "float32", "double": "float64", "int": "int32", "uint": "uint32"}


@dataclass
class Opened:
    """An open file. `image` is an `ImageInput`, a `DecodedPicture` or a `SlideReader`; `spec` and `kind` are
    OpenImageIO's header and format name; `header` and `metadata` are those of the upright picture. channels: what the
    file declares of them; associated: whether colours are multiplied by alpha; page: which of the file's it is.
    """

    path: Path
    image: Any
    spec: ImageSpec
    kind: str
    header: Probe
    metadata: Metadata
    channels: Channels
    associated: bool
    page: PageChoice = ONLY
    rounding: float = 0.0
    """By how much a sample that was read is off at most from what the file holds; infinite where alpha clipped it."""
    misfit: str | None = None
    """What is said of an ICC profile that is not kept."""
    shines: bool = False
    """Whether colours that are multiplied by alpha were there where it is 0: light without a body."""

    @property
    def orientation(self) -> int:
        """How stored pixels must be turned, 1 to 8."""
        return orientation(self.spec, self.kind)

    @property
    def native(self) -> np.dtype[Any]:
        """The type of stored samples, as `samples` gives them."""
        if holds_shifted_uint16(self.spec, self.kind):
            return np.dtype(np.uint16)
        name = str(self.spec.format)
        return np.dtype(_NUMPY_NAMES.get(name, name))

    @property
    def in_library(self) -> int:
        """How many times the size of all samples the library that reads them holds."""
        return self.image.in_library if isinstance(self.image, Reader) else _IN_LIBRARY.get(self.kind, 0)

    @property
    def reads_parts(self) -> bool:
        """Whether a part of the rows can be read: OpenImageIO 3.2 returns garbage for those of 64-bit floats."""
        return not (is_openimageio(self.image) and str(self.spec.format) == "double")

    @property
    def alpha_is_band(self) -> bool:
        """Whether what it declares as alpha is a band like the others, as these are neither gray nor RGB."""
        is_declared = self.spec.alpha_channel >= 0 and self.channels.last == "alpha"
        return is_declared and header(self.spec, self.kind).channels == "multi"

    @property
    def nodata(self) -> float | None:
        """The sample value that stands for "nothing was measured here", or None."""
        return geo.nodata(self.metadata.geo, self.header.dtype)

    def left_behind(self) -> list[str]:
        """What the page says that is not kept; read for that."""
        if isinstance(self.image, SlideReader | ZarrReader):
            return self.image.left_behind()
        with self.path.open("rb") as file:
            directory = self.page.directory
            data = PageBytes(file, directory) if directory and directory.number else FileBytes(file)
            kept = stated_of_samples(self.metadata.geo)
            found = left_behind(data) + [name for name in stated_of_samples(data) if name not in kept]
            if self.metadata.geo is None and jp2.states_place(FileBytes(file)):
                found.append("its place (GML; the extra tiff reads it)")
            if ifd.entries(data, {geo.RPC}) and geo.RPC not in geo.load(self.metadata.geo):
                found.append("RPC, for it is turned")
            found += others_below(data)
        found += [self.misfit] if self.misfit else []
        found += not_kept(self.spec, self.kind) if is_openimageio(self.image) else self.image.left_behind()
        return found + [f"what {name} says" for name in files_beside(self.path)]

    def reopen(self) -> None:
        """Close the file and open it again: OpenImageIO then stands at the first row again."""
        if is_openimageio(self.image):
            self.image.close()
            self.image = open_image(self.path)

    def samples(self, method: Callable[..., Any], rows: int, *where: int) -> Samples:
        """What a method of `image` reads of the page, [rows, columns, C] in the native type.

        where: the method's arguments between those that name the picture and those that name the channels. Any
        complaint raises PictureError: what came with it may be half a picture.
        """
        early = complaint(self.image, self.path)
        try:
            with without_libpng(self.kind == "png"):
                pixels = method(self.page.subimage, 0, *where, 0, self.spec.nchannels, self.spec.format)
        except MemoryError:
            raise PictureError("there is not enough memory for its pixels") from None
        found = early or complaint(self.image, self.path)
        if pixels is None or found:
            raise PictureError(found or "its pixels cannot be read; the file is damaged or cut off")
        stored = np.asarray(pixels).reshape(rows, -1, self.spec.nchannels)
        if is_openimageio(self.image) and (shift := bits_shifted(self.spec, self.kind)):
            stored = stored >> np.uint32(shift)
        return stored.view(np.uint16) ^ np.uint16(1 << 15) if holds_shifted_uint16(self.spec, self.kind) else stored

    def finished(self, stored: Samples) -> Samples:
        """Stored samples of the picture, or of a part, as `Picture` wants them: upright, alpha unassociated."""
        is_float = self.header.dtype == np.float32
        pixels = self._narrowed(stored) if is_float else stored.astype(self.header.dtype, copy=False)
        if self.channels.order is not None:
            pixels = pixels[..., self.channels.order]
        white = is_white_zero(self.spec) and (self.spec.nchannels > 1 or pixels.dtype != np.uint8)
        if white and pixels.dtype == np.uint8:
            pixels = ~pixels
        if self.associated:
            self.rounding = math.inf if is_clipped(pixels) else self.rounding
            self.shines = self.shines or (is_float and bool(pixels[pixels[..., -1] == 0].any()))
            pixels = unassociate(pixels)
        if white:
            pixels = np.concatenate([~pixels[..., :1], pixels[..., 1:]], axis=-1)
        pixels = pixels[..., : self.header.count]
        return upright(pixels, self.orientation)

    def _narrowed(self, stored: Samples) -> Samples:
        pixels, off = narrowed(stored, geo.nodata(self.metadata.geo, self.native))
        self.rounding = max(self.rounding, off)
        return pixels


def open_picture(path: Path, *, any_size: bool = False, alpha: Alpha = "auto", page: int | None = None) -> Opened:
    """Open a file and read its header and metadata, not its pixels.

    any_size: lift OpenImageIO's own limit (32 GiB, or the machine's memory) for a TIFF, which can be read in parts.
    alpha: what the last of two or four channels is: what the file declares, a band like the others, or left out.
    page: from 1; the first if None.

    Raises PictureError for what cannot be read faithfully, UsageError for another `alpha` or a page that is not there.
    """
    if alpha not in get_args(Alpha):
        raise UsageError(f"alpha {alpha!r}; it is one of {', '.join(get_args(Alpha))}")
    load_openimageio("reading pictures")
    if is_slide(path):
        check_page(page, 1)
        slide = SlideReader(path)
        spec, kind = slide.spec(), slide.format_name()
        return Opened(path, slide, spec, kind, header(spec, kind), slide.metadata(), AsIs, False)
    if is_zarr(path):
        return _zarr_picture(path, alpha, page)
    with path.open("rb") as file:
        data = FileBytes(file)
        other = _check(data)
        if other is not None:
            return _sniffed_picture(path, other, embedded.extract(data), alpha, page)
        with no_size_limit() if any_size and ifd.layout(data) is not None else nullcontext():
            image = open_image(path, page=page)
        chosen = _chosen(path, data, image, page)
        if chosen.directory is not None and chosen.directory.number:
            data = PageBytes(file, chosen.directory)
            _refuse(ifd.damage(data))
        if larger := larger_below(data):
            size = "×".join(map(str, larger))
            raise PictureError(
                f"it is a preview: a picture of {size} pixels in a sub-directory is not read; save that first"
            )
        found = embedded.extract(data)
        if found.geo is None and jp2.states_place(data):
            found = replace(found, geo=place_by_gdal(path))
        declared = declared_channels(data, image.format_name())
        if declared.second or chosen.left_out:
            image = open_image(path, second=True, page=page)
        image = by_others(path, data, image, chosen, declared)
        spec, kind = _spec(image, found, chosen.subimage), image.format_name()
        stated = _profile(spec) or icc.stated(data)
    probe = _probe(image, spec, _LAST.get(alpha, declared.last))
    colours = band_colours(spec, alpha == "auto") if (kind, probe.channels) == ("tiff", "multi") else []
    georeference = with_colours(_with_names(found.geo, image), colours)
    if not has_own_numbers(spec):
        georeference = geo.resampled(georeference, lambda value: number_as_read(value, spec))
    georeference = placement.oriented(georeference, orientation(spec, kind), spec.width, spec.height)
    if kind in ALREADY_UPRIGHT:
        found = embedded.turned_already(found, spec.width, spec.height)
    else:
        found = embedded.upright(found, orientation(spec, kind), spec.width, spec.height)
    profile, misfit = icc.fitting(stated, probe.channels)
    metadata = replace(found, icc=profile, geo=georeference)
    has_alpha = declared.last == "alpha" and alpha_index(header(spec, kind).channels) is not None
    associated = has_alpha and alpha != "band" and (declared.associated or is_associated(spec, kind))
    return Opened(path, image, spec, kind, probe, metadata, declared, associated, chosen, misfit=misfit)


def _chosen(path: Path, data: FileBytes, image: ImageInput | DecodedPicture, page: int | None) -> PageChoice:
    return PageChoice(pages=image.pages) if isinstance(image, DecodedPicture) else chosen_page(path, data, image, page)


_READERS: dict[str, Callable[[Path, int | None], DecodedPicture]] = {
    "avif": AvifReader,
    "heif": HeifReader,
    "raw": RawReader,
}


def _sniffed_picture(path: Path, found: SniffedFormat, metadata: Metadata, alpha: Alpha, page: int | None) -> Opened:
    """One that a library of its own decodes. metadata: that in the bytes of the file."""
    try:
        image = _READERS[found.name](path, page)
    except MissingExtraError as error:
        raise PictureError(f"it is {found.what}; {error}, or {found.program}") from None
    spec, kind, own = image.spec(), image.kind, image.metadata()
    probe = header(spec, kind, _LAST.get(alpha, "alpha"))
    profile, misfit = icc.fitting(own.icc, probe.channels)
    own = Metadata(icc=profile, exif=own.exif or metadata.exif, xmp=own.xmp or metadata.xmp)
    own = embedded.turned_already(own, probe.width, probe.height, image.turned)
    has_alpha = alpha != "band" and alpha_index(header(spec, kind).channels) is not None
    associated = has_alpha and image.associated
    pages = PageChoice(pages=image.pages)
    return Opened(path, image, spec, kind, probe, own, AsIs, associated, pages, misfit=misfit)


def _zarr_picture(path: Path, alpha: Alpha, page: int | None) -> Opened:
    image = ZarrReader(path, page)
    spec = image.spec()
    probe = _probe(image, spec, _LAST.get(alpha, "alpha"))
    return Opened(path, image, spec, image.kind, probe, image.metadata(), AsIs, False, PageChoice(pages=image.pages))


def _probe(image: Any, spec: ImageSpec, last: Last) -> Probe:
    """The header; where its reader knows that channels are no colours, they are none."""
    if is_openimageio(image) and (reason := unread_floats(spec)) is not None:
        raise PictureError(f"{reason}, which cannot be read; save it as 32-bit floats")
    probe = header(spec, image.format_name(), last)
    return replace(probe, channels="multi") if getattr(image, "layout", None) == "multi" else probe


def _with_names(georeference: bytes | None, image: Any) -> bytes | None:
    """The blob, with the names of bands that the reader knows of planes."""
    named = geo.load(image.metadata().geo) if isinstance(image, Planes) else {}
    return geo.pack(geo.load(georeference) | named) if named else georeference


def _check(data: FileBytes) -> SniffedFormat | None:
    """Raise PictureError for what the bytes of a file rule out. Returns what needs a library of its own."""
    if len(data) == 0:
        raise PictureError("the file is empty")
    if data[:8] == _STREAM_SIGNATURE:
        raise PictureError("this is an encoded stream, not a picture; decode it first")
    found = sniffed_format(data)
    if found is not None and not _reads(found.name):
        return found
    finder = png if data[:8] == png.SIGNATURE else radiance if radiance.is_radiance(data) else ifd
    _refuse(finder.damage(data))
    return None


def _refuse(damage: str | None) -> None:
    if damage:
        raise PictureError(damage)


def _reads(name: str) -> bool:
    """Whether this build of OpenImageIO reads a format."""
    import OpenImageIO as oiio

    return name in oiio.get_string_attribute("format_list").split(",")


def _spec(image: Any, found: Metadata, subimage: int) -> ImageSpec:
    """The header of the page. Its orientation is that of the EXIF that is kept, so that pixels and tag agree; one that
    stands there, or in XMP alone, OpenImageIO does not always see.
    """
    import OpenImageIO as oiio

    if is_openimageio(image):
        image.seek_subimage(subimage, 0)
    spec = oiio.ImageSpec(image.spec())
    other = None if spec.get("Orientation") is None else spec.get_int_attribute("Orientation", 1)
    spec.attribute("Orientation", embedded.orientation(found, other))
    return spec


def _profile(spec: ImageSpec) -> bytes | None:
    profile = spec.get("ICCProfile")
    return None if profile is None else np.asarray(profile, np.uint8).tobytes()
