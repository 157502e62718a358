"""The metadata of what a view shows: its place on the map, its size and its pixels per inch."""

from __future__ import annotations

from dataclasses import replace

from sgicodec.bitstream.header import Header
from sgicodec.decoder.view import View
from sgicodec.metadata.blobs import Metadata


def view_metadata(found: Metadata, sample_type: str, header: Header, view: View) -> Metadata:
    """The metadata of what a view shows, in samples as of `header`, from those of a stream of `sample_type`."""
    if (found.exif, found.xmp) != (None, None):
        from sgicodec.metadata.motion import Motion

        motion = Motion(header.width, header.height, 1, view.x, view.y, view.sx, view.sy, view.columns, view.rows)
        if not motion.is_none:
            from sgicodec.metadata.embedded import moved  # takes long to load

            found = moved(found, motion)
    if found.geo is None and header.blank is None:
        return found
    from sgicodec.metadata import geo
    from sgicodec.metadata.placement import view as geo_view  # takes long to load

    georeference = geo_view(found.geo, view.x, view.y, view.sx, view.sy)
    if header.sample_type != sample_type:
        georeference = geo.resampled(georeference, lambda _: header.nodata)
    if header.blank is not None:
        georeference = geo.with_nodata(georeference, header.blank)
    return replace(found, geo=georeference)
