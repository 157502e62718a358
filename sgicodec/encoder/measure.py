"""How far a stream is from its picture, band by band."""

from __future__ import annotations

from sgicodec.decoder.stream import Stream
from sgicodec.encoder.input.windows import Windows
from sgicodec.metrics.distortion import decibels, squared_error

__all__ = ["measured_error", "measured_psnr"]


def measured_error(stream: Stream, windows: Windows) -> float:
    """Squared error over all samples of what the stream decodes to, in 0..1, but for colours where alpha is 0."""
    return sum(squared_error(windows.read(0, top, band.width, band.height), band) for top, band in stream.bands())


def measured_psnr(stream: Stream, windows: Windows) -> float:
    """The same as PSNR in dB."""
    header = stream.header
    return decibels(measured_error(stream, windows), header.width * header.height * header.spec.channels)
