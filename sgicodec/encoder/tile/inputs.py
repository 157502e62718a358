"""A tile as all stages see it, made of pixels and a plan."""

from __future__ import annotations

from dataclasses import replace
from math import isnan

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.input.nodata import Bare, bare_samples, empty_pixels, inpaint
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.tile.state import Tile, TileListener, Watch
from sgicodec.encoder.tile.texture_steps import TUNINGS, Masking
from sgicodec.metrics.choices import DISTORTIONS
from sgicodec.model.luma_space import to_luma_space
from sgicodec.picture import Picture, nodata_samples, opaque_mask, to_unit

__all__ = ["tile_of"]


def tile_of(
    picture: Picture,
    plan: Plan,
    device: Device = ALL_CORES,
    number: int = 0,
    *,
    listener: TileListener | None = None,
) -> Tile:
    """Tile `number` of a stream, whose pixels are `picture`."""
    header = plan.header.of_tile(number) if plan.header.tile else _with_least_masks(plan.header, picture)
    settings = plan.settings
    if settings.seeds is not None:
        part = picture.width * picture.height / (plan.header.width * plan.header.height)
        settings = replace(settings, seeds=max(1, round(settings.seeds * part)))
    fit = settings.fit_settings()
    if plan.header.tile:
        fit = replace(fit, quality=header.quality)
    bare = bare_samples(picture, header)
    unit, empty = _coded_samples(picture, header, bare)
    masking = Masking(TUNINGS[settings.tuned_for], unit)
    if header.spec.luma_space:
        unit = np.tensordot(to_luma_space(header.spec.channels).astype(np.float32), unit, axes=1)
    return Tile(
        picture,
        plan,
        number,
        header,
        settings,
        fit,
        settings.chosen_effort,
        unit,
        empty,
        bare,
        DISTORTIONS[settings.minimised].reference(unit, empty),
        masking,
        Watch(listener or _NoListener()),
        device,
    )


def _with_least_masks(header: Header, picture: Picture) -> Header:
    """The header of the only tile, which says of masks no more than it needs. A number that is nodata stays, even where
    no sample has it: none may become it.
    """
    if header.masked == "nodata":
        nodata = nodata_samples(picture)
        masked, differ = nodata.any() or not isnan(header.nodata), bool((nodata != nodata[..., :1]).any())
    else:
        masked, differ = empty_pixels(picture, header.masked).any(), False
    return replace(header, masked=header.masked if masked else None, has_band_masks=differ)


_BEYOND_OPAQUE = 0.05
"""Decoders clip alpha, so that errors up to this leave opaque what is; with 0.02 to 0.1, sizes differ by 1 %."""


def _coded_samples(
    picture: Picture, header: Header, bare: Bare
) -> tuple[NDArray[np.float32], NDArray[np.bool_] | None]:
    """Samples [C, H, W] in 0..1, opaque alpha a little above, and which pixels [H, W] need not be coded, None for none;
    they continue the others. So do single samples that no model shows.
    """
    samples = to_unit(picture)
    if picture.alpha is not None:
        samples[opaque_mask(picture), picture.alpha] = 1.0 + _BEYOND_OPAQUE
    unit = np.ascontiguousarray(samples.transpose(2, 0, 1))
    if header.masked == "transparent":
        empty = empty_pixels(picture, header.masked)
        return (inpaint(unit, empty), empty) if empty.any() else (unit, None)
    either = bare.either
    if either is None:
        return unit, None
    empty = np.asarray(either.all(axis=-1))
    if empty.all() and bare.exact is not None:
        return np.zeros_like(unit), None  # a model must carry what is stated
    for band in range(either.shape[2]):
        if (either[..., band] != empty).any():
            unit[band] = inpaint(unit[band : band + 1], either[..., band])[0]
    return (inpaint(unit, empty), empty) if empty.any() else (unit, None)


class _NoListener:
    """A `TileListener` that lets a tile go its way."""

    def stage(self, name: str) -> None:
        """Ignored."""

    def step(self, progress: object) -> bool:
        """Goes on."""
        return True

    def ending(self) -> bool:
        """No."""
        return False
