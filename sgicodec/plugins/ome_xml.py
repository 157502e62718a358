"""OME's description of a picture, as the first directory of an OME-TIFF has it. By tifffile."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from sgicodec.decoder.stream import Stream
from sgicodec.metadata.gdal_items import band_facts
from sgicodec.metadata.slides import magnification
from sgicodec.metadata.tiff import DESCRIPTION, described

_UNPRINTABLE = re.compile(r"[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no words for."""
_UUID = re.compile(r' UUID="[^"]*"')
"""Of tifffile, made of the time and the address of the machine; equal pictures are to make equal files."""


def has_planes(stream: Stream) -> bool:
    """Whether each channel is a plane of its own, with its name: those that are no colours."""
    return stream.header.channels == "multi" and stream.header.spec.channels > 1


def ome_xml(
    stream: Stream, width: int, height: int, dtype: np.dtype[Any], microns: tuple[float, float] | None
) -> bytes:
    """The size of the picture, that of a pixel in micrometres, names of bands, the picture's description, the
    magnification of the objective.
    """
    import tifffile

    count, facts = stream.header.spec.channels, dict[str, Any](Name="Image0")
    if microns is not None:
        facts |= {f"PhysicalSize{axis}": size for axis, size in zip("XY", microns, strict=True)}
        facts |= {"PhysicalSizeXUnit": "µm", "PhysicalSizeYUnit": "µm"}
    document = tifffile.OmeXml()
    names = [band.description or "" for band in band_facts(stream.metadata.geo, count)]
    facts |= {"Channel": {"Name": names}} if any(names) and (has_planes(stream) or count == 1) else {}
    description = described(stream.metadata.exif).get(DESCRIPTION)
    if description is not None:
        facts["Description"] = _UNPRINTABLE.sub("", description.data.decode("utf-8", "replace"))
    if has_planes(stream):
        document.addimage(dtype, (count, height, width), (count, 1, 1, height, width, 1), axes="CYX", **facts)
    else:
        shape = (height, width, *((count,) if count > 1 else ()))
        document.addimage(dtype, shape, (1, 1, 1, height, width, count), axes="YXS"[: len(shape)], **facts)
    text = _UUID.sub("", document.tostring(declaration=True), count=1)
    power = None if description is None else magnification(description.data)
    return (text if power is None else _with_objective(text, power)).encode()


def _with_objective(text: str, power: str) -> str:
    """OME's document of one image with the magnification of its objective, which tifffile has no words for."""
    objective = f'<Objective ID="Objective:0" NominalMagnification="{power}"/>'
    instrument = f'<Instrument ID="Instrument:0">{objective}</Instrument>'
    used = '<InstrumentRef ID="Instrument:0"/><ObjectiveSettings ID="Objective:0"/>'
    return text.replace("<Image ", instrument + "<Image ", 1).replace("<Pixels ", used + "<Pixels ", 1)
