"""Reading pictures whole: anything that OpenImageIO reads, or refused."""

from __future__ import annotations

from pathlib import Path

from sgicodec.errors import PictureError
from sgicodec.image.access import whole
from sgicodec.image.extremes import Extremes
from sgicodec.image.foreign import foreign
from sgicodec.image.header import MAX_SAMPLES, Probe
from sgicodec.image.opened import Alpha, Opened, open_picture
from sgicodec.image.origin import Origin, has_signature, naming, on_disk
from sgicodec.metadata.filebytes import FileBytes
from sgicodec.picture import Picture, full_range

__all__ = ["check_whole", "is_picture", "probe", "read"]


def read(
    origin: Origin,
    *,
    max_samples: int = MAX_SAMPLES,
    sample_range: tuple[float, float] | None = None,
    alpha: Alpha = "auto",
    page: int | None = None,
) -> Picture:
    """Read one image of a file, of bytes, or of a stream from where it stands.

    sample_range states which colour samples stand for 0 and 1. Without it integers use the full range of
    their type, floats the range that they are found to have. alpha: "auto" takes for alpha what the file declares as
    such, "band" codes it as a band like the others, "none" leaves it out. page: of a file with several, from 1; the
    first if None.

    Raises PictureError, one line that names the origin, for what cannot be read whole and faithfully or has
    more than max_samples samples; UsageError for a range that is none, and for a page that is not there.
    """
    with naming(origin), on_disk(origin) as path:
        opened = open_picture(path, alpha=alpha, page=page)
        check_whole(opened, max_samples)
        pixels = opened.finished(whole(opened))
        if sample_range is None and pixels.dtype.kind == "u":
            sample_range = full_range(pixels.dtype)
        elif sample_range is None:
            found = Extremes(opened.header.channels, opened.nodata)
            found.add(pixels)
            sample_range = found.range()
        return Picture(pixels, opened.header.channels, sample_range, opened.metadata)


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
        if has_signature(file.read(16)) or foreign(FileBytes(file)) is not None:
            return True
    try:
        probe(path)
    except PictureError:
        return False
    return True
