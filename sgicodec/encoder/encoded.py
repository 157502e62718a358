"""What an encode gives: a finished stream and its figures, and how far it is from its picture."""

from __future__ import annotations

from dataclasses import dataclass, field

from sgicodec.decoder.stream import Stream
from sgicodec.encoder.input.windows import Windows
from sgicodec.metrics.distortion import decibels, squared_error

__all__ = ["Encoded", "measured_error", "measured_psnr"]


@dataclass(frozen=True)
class Encoded:
    """A finished stream and its figures.

    data: the stream; empty if it went to an output. part_bytes: what each part of the tiles costs.
    seeds, gaussians: how many there are. steps: of the fit, the mean over the tiles that had one. ended_early: whether
    the caller ended the fit. psnr: dB over all samples of what was decoded, but for colours where alpha is 0; None if
    it was not measured. devices: by the name of what fitted, a GPU or the processor, how many tiles it did.
    """

    data: bytes = field(repr=False)
    part_bytes: dict[str, float] = field(repr=False)
    seeds: int
    gaussians: int
    lmbda: float
    steps: int = 0
    ended_early: bool = False
    psnr: float | None = None
    devices: dict[str, int] = field(default_factory=dict, repr=False)
    written: int = 0
    """Bytes of a stream whose data are not here."""

    @property
    def size(self) -> int:
        """Bytes of the stream."""
        return len(self.data) or self.written


def measured_error(stream: Stream, windows: Windows) -> float:
    """Squared error over all samples of what the stream decodes to, in 0..1, but for colours where alpha is 0."""
    return sum(squared_error(windows.read(0, top, band.width, band.height), band) for top, band in stream.bands())


def measured_psnr(stream: Stream, windows: Windows) -> float:
    """The same as PSNR in dB."""
    header = stream.header
    return decibels(measured_error(stream, windows), header.width * header.height * header.spec.channels)
