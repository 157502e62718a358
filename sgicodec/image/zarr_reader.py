"""OME-Zarr (NGFF) images, by zarr: the largest level, a plane of which is a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, require
from sgicodec.image.decoded_picture import Reader
from sgicodec.image.pages import check_page
from sgicodec.metadata import geo
from sgicodec.metadata.gdal_items import named_bands
from sgicodec.metadata.stacks import resolution_tags
from sgicodec.picture import Metadata

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_MARKS = ("zarr.json", ".zgroup", ".zattrs", ".zarray")
"""Files that a folder of Zarr, of version 3 or 2, may hold."""

_SAMPLES = ("uint8", "uint16", "int8", "int16", "int32", "uint32", "float32", "float64")
_OLD_AXES = ("t", "c", "z", "y", "x")
_COLOURS = (("FF0000", "00FF00", "0000FF"), ("RED", "GREEN", "BLUE"), ("R", "G", "B"))
_MICRONS = {"nanometer": Fraction(1, 1000), "micrometer": Fraction(1), "millimeter": Fraction(1000)}
_MICRONS |= {"centimeter": Fraction(10**4), "meter": Fraction(10**6), "angstrom": Fraction(1, 10**4)}


def is_zarr(path: Path) -> bool:
    """Whether a folder holds Zarr."""
    return path.is_dir() and any((path / name).is_file() for name in _MARKS)


class ZarrReader(Reader):
    """A plane of an open OME-Zarr image, channels last. pages: how many planes it has, over z and t."""

    kind = "ome-zarr"

    def __init__(self, path: Path, page: int | None) -> None:
        """Raises PictureError for what is no image of OME-Zarr, UsageError for a page that is not there."""
        require("zarr", "reading OME-Zarr", "zarr")
        try:
            self._scales, self._omero, self._array, self._lost = _opened(path)
        except (KeyError, TypeError, AttributeError, ValueError, IndexError) as error:
            raise PictureError(f"its OME-Zarr metadata are damaged: {' '.join(str(error).split())}") from error
        self._axes = _axes(self._scales, self._array.ndim)
        sizes = dict(zip(self._axes, self._array.shape, strict=True))
        self._count, self._height, self._width = sizes.get("c", 1), sizes["y"], sizes["x"]
        outer = {name: size for name, size in sizes.items() if name not in "cyx"}
        self.pages = int(np.prod(list(outer.values()), dtype=np.int64))
        check_page(page, self.pages)
        self.layout = self._layout()
        where = np.unravel_index((page or 1) - 1, tuple(outer.values())) if outer else ()
        self._plane = dict(zip(outer, map(int, where), strict=True))
        if str(self._array.dtype.newbyteorder("=")) not in _SAMPLES:
            raise PictureError(f"its samples are of type {self._array.dtype}; save it with 8, 16 or 32 bits per sample")

    def _layout(self) -> str | None:
        """That of pictures, or None where it follows from the number of channels."""
        labels, colours = ([str(c.get(key, "")).upper() for c in self._omero] for key in ("label", "color"))
        if self._count == 1:
            return None
        if self._count == 2:
            return "gray+alpha" if labels[1:] == ["ALPHA"] else "multi"
        coloured = tuple(colours[:3]) in _COLOURS or tuple(labels[:3]) in _COLOURS
        if self._count == 4 and labels[3:] == ["ALPHA"] and coloured:
            return "rgba"
        return "rgb" if self._count == 3 and coloured else "multi"

    def left_behind(self) -> list[str]:
        """Labels, further images, and colours of channels that are neither gray nor RGB."""
        coloured = self.layout in (None, "multi") and {_colour(channel) for channel in self._omero} - {"", "FFFFFF"}
        return self._lost + ["colours of channels"] * bool(coloured)

    def metadata(self) -> Metadata:
        """The size of a pixel, and names of channels that are no colours."""
        tags = resolution_tags(_microns(self._scales, self._axes))
        names = [str(channel.get("label") or "") for channel in self._omero]
        if self.layout == "multi" or (self.layout is None and [name.upper() for name in names] != ["GRAY"]):
            tags |= named_bands(names)
        return Metadata(geo=geo.pack(tags))

    def spec(self) -> ImageSpec:
        """The header in OpenImageIO's terms."""
        import OpenImageIO as oiio

        dtype = str(self._array.dtype.newbyteorder("="))
        names = {"float64": "double", "float32": "float", "int32": "int", "uint32": "uint"}
        spec = oiio.ImageSpec(self._width, self._height, self._count, oiio.TypeDesc(names.get(dtype, dtype)))
        if self.layout in ("rgba", "gray+alpha"):
            spec.channelnames = ("R", "G", "B", "A") if self._count == 4 else ("Y", "A")
            spec.alpha_channel = self._count - 1
        chunks = dict(zip(self._axes, self._array.chunks, strict=True))
        spec.tile_width, spec.tile_height = chunks["x"], chunks["y"]
        return spec

    def read_tiles(self, _: int, __: int, *where: Any) -> npt.NDArray[Any]:
        """Samples [h, w, C] from column where[0] to where[1], row where[2] to where[3]. Raises PictureError."""
        left, right, top, bottom = where[:4]
        inner = {"c": slice(None), "y": slice(top, bottom), "x": slice(left, right)}
        try:
            samples = np.asarray(self._array[tuple((inner | self._plane)[axis] for axis in self._axes)])
        except Exception as error:  # stores and codecs raise what they like
            raise PictureError(f"it is damaged: {' '.join(str(error).split())}") from error
        planes = samples if "c" in self._axes else samples[None]
        samples = np.moveaxis(planes, 0, -1)
        return np.ascontiguousarray(samples, samples.dtype.newbyteorder("="))


def _colour(channel: Mapping[str, Any]) -> str:
    return str(channel.get("color") or "").upper()


def _opened(path: Path) -> tuple[Mapping[str, Any], Sequence[Mapping[str, Any]], Any, list[str]]:
    """The first multiscale image, its channels in the words of OMERO, the array of its largest level, and what stands
    beside it.
    """
    import zarr

    try:
        group = zarr.open_group(path, mode="r")
    except Exception as error:  # an array, or what is no Zarr
        raise PictureError(f"it is no group of Zarr that can be read: {' '.join(str(error).split())}") from error
    attributes: dict[str, Any] = dict(group.attrs)
    attributes = attributes.get("ome", attributes)
    if "plate" in attributes or "well" in attributes or "bioformats2raw.layout" in attributes:
        raise PictureError(f"it holds several images; name one of them, such as {path.name}/0")
    if not attributes.get("multiscales"):
        raise PictureError("it is Zarr without an image of OME (multiscales)")
    scales = attributes["multiscales"][0]
    array = group[str(scales["datasets"][0]["path"])]  # never outside the group
    if not isinstance(array, zarr.Array):
        raise PictureError("its largest level is no array")
    beside = {"labels": "labels" in group, "further images": len(attributes["multiscales"]) > 1}
    lost = [name for name, is_there in {**beside, "colours of labels": "image-label" in attributes}.items() if is_there]
    return scales, attributes.get("omero", {}).get("channels", []), array, lost


def _axes(scales: Mapping[str, Any], count: int) -> list[str]:
    """The names of so many axes. Raises PictureError for those that are no planes."""
    stated = scales.get("axes", _OLD_AXES[-count:] if count < 5 else _OLD_AXES)
    names = [str(axis["name"] if isinstance(axis, Mapping) else axis).lower() for axis in stated]
    if len(names) != count or names[-2:] != ["y", "x"] or len(set(names)) != count:
        raise PictureError(f"its axes are {', '.join(names)}, not some of t, z, c, y, x in {count} dimensions")
    return names


def _microns(scales: Mapping[str, Any], axes: Sequence[str]) -> list[Fraction | str | None]:
    """The size of a pixel in x and y, in micrometres; nothing where it is not stated."""
    stated = scales.get("axes", ())
    units = [axis.get("unit") if isinstance(axis, Mapping) else None for axis in stated]
    transforms = [
        *scales["datasets"][0].get("coordinateTransformations", ()),
        *scales.get("coordinateTransformations", ()),
    ]
    sizes: list[Fraction | str | None] = []
    for axis in (axes.index("x"), axes.index("y")):
        scale = _MICRONS.get(units[axis] or "") if len(units) == len(axes) else None
        for transform in transforms:
            if scale is not None and transform.get("type") == "scale":
                scale *= Fraction(str(transform["scale"][axis]))
        sizes.append(scale)
    return sizes
