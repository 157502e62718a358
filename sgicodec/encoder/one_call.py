"""A picture to a stream in one call: `encode` and `imwrite`."""

from __future__ import annotations

import os
import warnings
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple

from sgicodec.device import ALL_CORES, Device
from sgicodec.encoder.pipeline import Encoded, encode_picture
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.settings import EncodeSettings, refuse_several_goals
from sgicodec.errors import PictureError, UsageError
from sgicodec.image.conversion import as_picture
from sgicodec.image.source import open_to_encode
from sgicodec.image.used_range import RangeChoice


def encode(
    image: object,
    *,
    channels: str | None = None,
    sample_range: RangeChoice | None = None,
    nodata: float | None = None,
    page: int | None = None,
    device: Device = ALL_CORES,
    **settings: Any,
) -> bytes:
    """The stream of an array [H, W] or [H, W, C], an image of Pillow, a Picture, or a picture file by its path.

    settings: those of `EncodeSettings`, such as quality=60, psnr=35, bpp=1.5, size=20_000 (bytes) or effort=3.
    channels, nodata: what the channels of an array are, and which samples were not measured. sample_range: the samples
    that stand for 0 and 1 of the model: "used", "type", or two numbers (`as_picture`). page: of a file that holds
    several, from 1; without it the first, and a warning.

    Raises UsageError, PictureError for what cannot be read or coded, TargetMissedError for a target out of reach.
    """
    return _encode(image, None, _Samples(channels, sample_range, nodata), page, device, settings).data


def imwrite(
    path: str | os.PathLike[str],
    image: object,
    *,
    channels: str | None = None,
    sample_range: RangeChoice | None = None,
    nodata: float | None = None,
    page: int | None = None,
    device: Device = ALL_CORES,
    **settings: Any,
) -> None:
    """Encodes a picture into the file `path`, a stream that appears whole or not at all.

    image and all other parameters: as of `encode`. Raises as `encode` does, PictureError too if the file cannot be
    written, OutputLockedError if another encode is writing it.
    """
    if not isinstance(path, str | os.PathLike):
        raise UsageError(f"a {type(path).__name__} is no path")
    samples = _Samples(channels, sample_range, nodata)
    try:
        _encode(image, Path(path), samples, page, device, settings)
    except OSError as error:
        raise PictureError(f"{path}: {error.strerror or error}") from error


class _Samples(NamedTuple):
    """What is said of samples, as `as_picture` takes it."""

    channels: str | None
    sample_range: RangeChoice | None
    nodata: float | None


def _encode(
    image: object,
    output: Path | None,
    samples: _Samples,
    page: int | None,
    device: Device,
    settings: dict[str, Any],
) -> Encoded:
    chosen = _settings(settings)
    listener = _Warner()
    if isinstance(image, bytearray | memoryview):
        image = bytes(image)
    is_file = isinstance(image, str | bytes | os.PathLike) or hasattr(image, "read")
    if is_file and samples.channels is None and samples.nodata is None:
        origin = os.fspath(image) if isinstance(image, os.PathLike) else image

        def note(text: str) -> None:
            warnings.warn(text, stacklevel=5)

        with open_to_encode(origin, note, sample_range=samples.sample_range, page=page) as source:  # type: ignore[arg-type]
            return encode_picture(source, chosen, output=output, device=device, progress=listener)
    if page is not None:
        raise UsageError("page is said of files; give the array or the image of that page")
    picture = as_picture(image, **samples._asdict())
    return encode_picture(picture, chosen, output=output, device=device, progress=listener)


class _Warner(NullListener):
    """Turns notes, as on alpha that hides all, into warnings of Python at the line that called `encode`."""

    def note(self, text: str) -> None:
        warnings.warn(text, stacklevel=6)


def _settings(given: dict[str, Any]) -> EncodeSettings:
    known = EncodeSettings.__dataclass_fields__
    for name in given:
        if name not in known:
            close = get_close_matches(name, known, 1)
            raise UsageError(f"there is no setting {name!r}" + (f"; did you mean {close[0]!r}?" if close else ""))
    chosen = {name: value for name, value in given.items() if value is not None}
    refuse_several_goals(chosen)
    return EncodeSettings(**chosen)
