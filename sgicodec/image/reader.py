"""Reading pictures whole: anything that OpenImageIO reads, or refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import PictureError
from sgicodec.image.access import whole
from sgicodec.image.header import MAX_SAMPLES, Probe
from sgicodec.image.opened import Alpha, Opened, open_picture
from sgicodec.image.origin import Origin, has_signature, naming, on_disk
from sgicodec.image.sniffed import sniffed_format
from sgicodec.image.used_range import RangeChoice, SampleUse, UsedRange, stated_use
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.filebytes import FileBytes
from sgicodec.metadata.layouts import alpha_index
from sgicodec.picture import Picture


def read(
    origin: Origin,
    *,
    max_samples: int = MAX_SAMPLES,
    sample_range: RangeChoice | None = None,
    alpha: Alpha = "auto",
    page: int | None = None,
) -> Picture:
    """Read one image of a file, of bytes, or of a stream from where it stands.

    sample_range: which colour samples stand for 0 and 1, "used", "type" or two numbers; by default the type's of eight
    bits, else the range in use. Samples outside a stated range are clipped. alpha: "auto" takes for alpha what the file
    declares as such, "band" codes it as a band like the others, "none" leaves it out. page: of a file with several,
    from 1; the first if None.

    Raises PictureError, one line that names the origin, for what cannot be read whole and faithfully or has
    more than max_samples samples; UsageError for a range that is none, and for a page that is not there.
    """
    with naming(origin), on_disk(origin) as path:
        opened = open_picture(path, alpha=alpha, page=page)
        check_whole(opened, max_samples)
        pixels = opened.finished(whole(opened))
        use = use_of(pixels, opened.header.channels, opened.nodata, sample_range)
        return pictured(pixels, opened.header.channels, use, opened.nodata, opened.metadata, opened.rounding)


def use_of(pixels: NDArray[Any], channels: str, nodata: float | None, choice: RangeChoice | None) -> SampleUse:
    """What the samples [H, W, C] of a whole picture are. nodata: the value that is declared as such.

    Raises UsageError, PictureError.
    """
    colours = pixels.shape[2] - (alpha_index(channels) is not None)
    use = stated_use(choice, pixels.dtype, colours)
    if use is None:
        found = UsedRange(channels, colours, pixels.dtype, nodata)
        found.add(pixels)
        use = found.found()
    return use


def pictured(
    pixels: NDArray[Any],
    channels: str,
    use: SampleUse,
    nodata: float | None,
    metadata: Metadata,
    rounding: float = 0.0,
) -> Picture:
    """The picture of samples whose use is known; rounding: as in `Picture`. Raises PictureError for not-a-number where
    nodata is another value and the range is stated.
    """
    clips = nodata is not None and not (use.exact or np.isnan(nodata))
    if clips and pixels.dtype.kind == "f" and np.isnan(pixels).any():
        raise PictureError("it holds samples that are not a number beside nodata; state no sample range to keep them")
    blank = use.blank if nodata is None else None
    return Picture(pixels, channels, use.sample_range, metadata, blank, use.exact, use.eight_bits, use.remark, rounding)


def check_whole(opened: Opened, max_samples: int) -> None:
    """Raise PictureError if the whole picture has more samples than may be held."""
    spec = opened.spec
    if spec.width * spec.height * spec.nchannels > max_samples:
        raise PictureError(
            f"{spec.width} × {spec.height} pixels of {spec.nchannels} channels are more than the cap of "
            f"{max_samples} samples"
        )


def probe(origin: Origin) -> Probe:
    """Read a picture's header, not its pixels. Raises PictureError as `read` does."""
    with naming(origin), on_disk(origin) as path:
        return open_picture(path).header


def is_picture(path: Path) -> bool:
    """Whether a file is a picture, sound or damaged, by its content."""
    with path.open("rb") as file:
        if has_signature(file.read(16)) or sniffed_format(FileBytes(file)) is not None:
            return True
    try:
        probe(path)
    except PictureError:
        return False
    return True
