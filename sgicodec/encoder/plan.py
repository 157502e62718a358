"""What the tiles of a stream have in common: header, settings, what the metadata chunks say."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sgicodec.bitstream.header import (
    COLOURED_LAYOUTS,
    MAX_CHANNELS,
    MAX_SIDE,
    MAX_TILES,
    Header,
    decode_header,
    encode_header,
)
from sgicodec.bitstream.limits import check_model, check_texture
from sgicodec.bitstream.parts.prior import parse_prior
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import LimitError, PictureError, StreamError, UsageError
from sgicodec.metadata import geo
from sgicodec.metadata.layouts import SampleRange, alpha_index
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import colour_step_of
from sgicodec.model.tile_grid import TileGrid
from sgicodec.picture import Metadata, Picture
from sgicodec.profiles.fit_settings import FitSettings
from sgicodec.rate_control.target import TARGETS
from sgicodec.version import __version__


@dataclass(frozen=True)
class Shape:
    """What is known of a picture before its pixels are: as in `Picture`, `bands` their number."""

    width: int
    height: int
    channels: str
    bands: int
    dtype: np.dtype[Any]
    sample_range: SampleRange
    metadata: Metadata
    nodata: float | None
    exact: bool = False
    eight_bits: bool = False
    remark: str | None = None
    rounding: float = 0.0

    @property
    def is_clipped(self) -> bool:
        """Whether colours were brighter than the alpha that they are multiplied by."""
        return math.isinf(self.rounding)

    @classmethod
    def of(cls, picture: Picture) -> Shape:
        """That of a picture in memory."""
        bands, dtype = picture.pixels.shape[2], picture.pixels.dtype
        shape = (picture.width, picture.height, picture.channels, bands, dtype)
        samples = (picture.exact, picture.eight_bits, picture.remark, picture.rounding)
        return cls(*shape, picture.sample_range, picture.metadata, picture.nodata, *samples)


@dataclass(frozen=True)
class Plan:
    """What the tiles of a stream have in common."""

    header: Header
    """What tiles are made by."""
    settings: EncodeSettings
    """Those of each tile."""
    software: bytes
    """What chunk `s` says."""
    metadata: Metadata | None
    """What travels with the picture, None for nothing."""
    eight_bits: bool = False
    """Whether colours are those of eight bits, stretched to the range and rounded."""
    calibrated_quality: float | None = None
    """The quality to whose mean score the only tile is brought, None where λ alone says what it looks like."""
    texture_lmbda: float | None = None
    """λ of texture, where it is not that of the tiles."""
    exact_alpha: bool = False
    """Whether alpha is in a residual layer, so that tiles show colours alone."""
    exact_bands: tuple[int, ...] = ()
    """Bands, from 0 on, that are in a residual layer, so that tiles need not show them."""

    def stated(self, header: Header) -> Header:
        """What a stream states of a header: where alpha is exact, no mask need say where it is 0."""
        return replace(header, masked=None) if self.exact_alpha else header

    def of_header(self, window: Picture) -> Picture:
        """A window as the header describes its samples, without metadata."""
        header = self.header
        return Picture(
            window.pixels,
            header.channels,
            header.sample_range,
            blank=header.blank,
            exact=header.has_exact,
            eight_bits=self.eight_bits,
        )

    def at(self, lmbda: float) -> Plan:
        """The same for tiles that are fitted at λ, whatever the target."""
        header = replace(self.header, colour_step=colour_step_of(lmbda))
        return replace(self, header=header, settings=self.settings.without_target(lmbda=lmbda))


def check_clipped(shape: Shape) -> None:
    """Raises PictureError for pixels that are not those of the file, whatever a residual layer adds."""
    if shape.is_clipped:
        raise PictureError(
            "the picture has colours brighter than the alpha that they are multiplied by, which are clipped: not every "
            "pixel can be kept; encode it without --lossless and --max-error"
        )


def stream_plan(shape: Shape, settings: EncodeSettings) -> Plan:
    """The header and settings of a picture's tiles. Raises as `encode`."""
    grid = settings.grid(shape.width, shape.height)
    _check_shape(shape)
    if settings.max_error is not None:
        check_clipped(shape)
    settings = _with_texture_that_fits(settings, shape.bands, grid)
    spec = settings.spec(shape.bands)
    if settings.tuned_for == "visual" and shape.channels in COLOURED_LAYOUTS and spec.plain:
        spec = replace(spec, luma_space=True)
    _check_model(spec, grid)
    fit = settings.fit_settings()
    header = Header(
        *(shape.width, shape.height, shape.channels, str(shape.dtype), shape.sample_range, settings.profile, spec),
        colour_step=colour_step_of(fit.lmbda),
        family=int(settings.profile == "default"),
        tile=grid.tile,
        apron=grid.apron,
        masked="nodata" if shape.nodata is not None else "transparent" if alpha_index(shape.channels) else None,
        nodata=shape.nodata or 0.0,
        has_band_masks=shape.nodata is not None and shape.bands - (alpha_index(shape.channels) is not None) > 1,
        has_exact=shape.exact,
        network=settings.network or b"",
    )
    if settings.network is not None:
        _check_network(header)
    if settings.prior is not None:
        parse_prior(settings.prior, spec)
    if grid.tile and settings.target is not None and TARGETS[settings.target].single_tile:
        raise UsageError(f"{settings.target} goes with a single tile only; --tile 0 makes one")
    place = geo.without_statistics(shape.metadata.geo)
    metadata = replace(shape.metadata, geo=place) if settings.metadata else None
    return Plan(header, settings, _software(settings, fit), metadata, shape.eight_bits)


def _with_texture_that_fits(settings: EncodeSettings, bands: int, grid: TileGrid) -> EncodeSettings:
    """Settings without texture where a tile is too large for any."""
    try:
        check_texture(bands, *grid.rect(0)[2:])
    except LimitError:
        return replace(settings, texture=False)
    return settings


def _check_network(header: Header) -> None:
    if not header.spec.restoration:
        raise UsageError("a network restores texture; without texture or restoration, leave it out")
    if not header.network:
        raise UsageError("this is no network of restoration: it is empty")
    try:
        decode_header(encode_header(header))
    except StreamError as error:
        raise UsageError(f"this is no network of restoration: {error}") from error


def _check_shape(shape: Shape) -> None:
    bands, sides = shape.bands, (shape.width, shape.height)
    if bands > MAX_CHANNELS or max(sides) > MAX_SIDE:
        size = f"{sides[0]}×{sides[1]} pixels of {bands} channels"
        raise PictureError(f"{size}; a stream holds at most {MAX_CHANNELS} channels and {MAX_SIDE} pixels a side")


def _check_model(spec: ModelSpec, grid: TileGrid) -> None:
    if grid.count > MAX_TILES:
        raise UsageError(f"tile {grid.tile}: {grid.count} tiles; a stream holds at most {MAX_TILES}")
    try:
        check_model(spec, *grid.rect(0)[2:])
    except LimitError as error:
        raise PictureError(str(error)) from error


def _software(settings: EncodeSettings, fit: FitSettings) -> bytes:
    """What chunk `s` says."""
    is_default = settings.profile == "default"
    if settings.target_label:
        asked = settings.target_label
    elif settings.lmbda is not None or not is_default:
        asked = f"l{fit.lmbda:g}"
    elif settings.quality is None and settings.max_error is not None:
        asked = f"max-error{settings.max_error:g}" if settings.max_error else "lossless"
    else:
        asked = f"q{settings.chosen_quality:g}"
    took = f"e{settings.effort}" if is_default and settings.steps is None else f"n{fit.steps}"
    asked += f" {settings.tuned_for}" if is_default else ""
    return f"{__version__} {asked} {took}".encode()
