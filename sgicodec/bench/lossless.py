"""Lossless and near-lossless coding of each picture's own samples, beside other codecs: `sgi bench --lossless`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sgicodec.bench.codec import Coded
from sgicodec.bench.rows import RowFile
from sgicodec.bench.run import checksum, name_of
from sgicodec.bench.sgi import SgiCodec
from sgicodec.errors import PictureError, SgiError, require
from sgicodec.metrics.psnr import Pixels, difference


@dataclass(frozen=True)
class LosslessRow:
    """One picture by one codec with one greatest error, in levels; floats by so much. Seconds are the processor's, None
    where the system does not tell.
    """

    codec: str
    version: str
    settings: str
    picture: str
    crc: str
    max_error: float
    width: int
    height: int
    bands: int
    bytes: int
    encode_seconds: float | None
    decode_seconds: float | None

    @property
    def key(self) -> tuple[object, ...]:
        return (self.codec, self.version, self.settings, self.picture, self.crc, self.max_error)


@dataclass(frozen=True)
class LosslessPeer:
    """A codec of imagecodecs, called `module` there, and the samples that it takes: types, numbers of bands (None for
    all), not-a-number. `near` are its options for a greatest error, where it has one.
    """

    name: str
    module: str
    options: dict[str, Any]
    types: tuple[str, ...] = ("uint8", "uint16")
    bands: tuple[int, ...] | None = None
    takes_nan: bool = False
    near: Callable[[float], dict[str, Any]] | None = None

    def version(self) -> str:
        require("imagecodecs", self.name, "bench")
        import imagecodecs

        return str(getattr(imagecodecs, f"{self.module}_version")())

    @property
    def fixed_settings(self) -> str:
        """All but the greatest error, in one line."""
        return " ".join(f"{name}={value}" for name, value in self.options.items())

    def takes(self, pixels: Pixels, max_error: float) -> bool:
        """Whether it can code such samples with such an error at all."""
        fits = pixels.dtype.name in self.types and (self.bands is None or pixels.shape[2] in self.bands)
        return fits and (not max_error or self.near is not None) and (self.takes_nan or not np.isnan(pixels).any())

    def coded(self, path: Path, pixels: Pixels, max_error: float) -> Coded:
        """Encoded and decoded in memory. Raises PictureError if the codec refuses the picture."""
        import imagecodecs

        encode, decode = (getattr(imagecodecs, f"{self.module}_{way}") for way in ("encode", "decode"))
        options = self.options | (self.near(max_error) if self.near else {})
        start = time.process_time()
        try:
            data = encode(pixels, **options)
            encoded = time.process_time()
            decoded = decode(data)
        except (ValueError, RuntimeError) as error:
            raise PictureError(f"{self.name} cannot code this picture: {error}") from error
        return Coded(len(data), decoded, encoded - start, time.process_time() - encoded)


LosslessCodec = LosslessPeer | SgiCodec

_ALL = ("uint8", "uint16", "float32")

PEERS = {
    peer.name: peer
    for peer in (
        LosslessPeer("png", "png", {"level": 9}, bands=(1, 2, 3, 4)),
        LosslessPeer("jpegls", "jpegls", {}, bands=(1, 3, 4), near=lambda error: {"level": int(error)}),
        LosslessPeer("webp", "webp", {"lossless": True, "level": 100}, types=("uint8",), bands=(3,)),
        LosslessPeer("lerc", "lerc", {"compression": "zstd"}, types=_ALL, near=lambda error: {"level": error}),
        LosslessPeer("jxl", "jpegxl", {"lossless": True, "effort": 7, "numthreads": 1}, types=_ALL, takes_nan=True),
    )
}
"""In the order of the formats' age, which is also the order of tables."""


def measure_lossless(
    pictures: Sequence[Path],
    codecs: Sequence[LosslessCodec],
    errors: Sequence[float],
    out_dir: Path,
    report: Callable[[str], None],
) -> tuple[list[LosslessRow], list[str]]:
    """Rows of all pictures, greatest errors and codecs that fit together, and a line for each that failed.

    What `out_dir/lossless.tsv` does not hold is measured and added. Raises UsageError for an unusable file there or a
    missing codec, PictureError for an unreadable picture.
    """
    from sgicodec.image.reader import read
    from sgicodec.picture import without_opaque_alpha

    versions = {codec.name: codec.version() for codec in codecs}
    out_dir.mkdir(parents=True, exist_ok=True)
    known = RowFile(LosslessRow, out_dir / "lossless.tsv")
    rows: list[LosslessRow] = []
    failures: list[str] = []
    for number, path in enumerate(pictures, 1):
        pixels, name = without_opaque_alpha(read(path)).pixels, name_of(path)
        height, width, bands = pixels.shape
        crc = checksum(pixels)
        fitting = [(codec, error) for error in errors for codec in codecs if codec.takes(pixels, error)]
        for codec, error in fitting:
            key = (codec.name, versions[codec.name], codec.fixed_settings, name, crc, error)
            if key not in known.rows:
                try:
                    coded = codec.coded(path, pixels, error)
                    check_error(pixels, coded.pixels, error)
                except SgiError as failure:
                    failures.append(f"{name}, {codec.name}, ±{error:g}: {failure}")
                    report(failures[-1])
                    continue
                seconds = (coded.encode_seconds, coded.decode_seconds)
                known.append(LosslessRow(*key, width, height, bands, coded.bytes, *seconds))
            rows.append(known.rows[key])
        report(f"{number}/{len(pictures)} {name} {width}x{height}, {bands} of {pixels.dtype}: {len(fitting)} points")
    return rows, failures


def check_error(pixels: Pixels, decoded: Pixels, max_error: float) -> None:
    """Raises PictureError where a decoded sample is farther off; floats may be off by one rounding besides."""
    if decoded.dtype != pixels.dtype or decoded.size != pixels.size:
        raise PictureError(f"decodes to {decoded.shape} of {decoded.dtype}")
    decoded = decoded.reshape(pixels.shape)
    off = np.abs(difference(pixels, decoded))[~(np.isnan(pixels) & np.isnan(decoded))]
    rounding = float(np.spacing(np.nanmax(np.abs(pixels)))) if pixels.dtype == np.float32 and max_error else 0.0
    if off.size and not off.max() <= max_error + rounding:
        raise PictureError(f"a sample is {off.max():g} off, more than {max_error:g}")
