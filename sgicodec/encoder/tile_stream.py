"""The stream of one picture, or of one tile by itself: written, and measured."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile_chunk import ExactSamples, encode_tile_chunk
from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.candidate import Candidate, written
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.nodata import Bare
from sgicodec.encoder.plan import Plan
from sgicodec.metrics.psnr import psnr
from sgicodec.metrics.visual_score import visual_score
from sgicodec.model.context import input_count
from sgicodec.picture import Picture, comparable, to_rgb8
from sgicodec.rate_control.target import Measured

__all__ = ["TileStream"]


@dataclass(frozen=True)
class TileStream:
    """Streams of a picture by its plan. empty [H, W]: pixels that need not be coded, None if there are none; bare: the
    samples that no model shows.
    """

    picture: Picture
    plan: Plan
    empty: NDArray[np.bool_] | None
    bare: Bare
    device: Device

    def nothing(self, lmbda: float) -> Encoded:
        """The stream of a picture that holds nothing."""
        return Encoded(self.assembled(self.plan.header, None)[0], {}, 0, 0, lmbda)

    def encoded(self, candidate: Candidate, lmbda: float) -> Encoded:
        """The stream of a candidate; lmbda: of the encode."""
        model, spec = candidate.model, candidate.header.spec
        texture = spec.texture and model.texture is not None
        restoration = spec.restoration and model.restoration is not None
        spec = replace(spec, texture=texture, restoration=restoration)
        candidate = replace(candidate, header=replace(candidate.header, spec=spec))
        payload, parts = written(candidate)
        data, chunk_bytes = self.assembled(candidate.header, payload)
        if candidate.header.masked is not None or candidate.header.has_exact:
            parts["mask"] = chunk_bytes - len(payload)
        seeds = len(candidate.model.layout)
        return Encoded(data, parts, seeds, seeds * candidate.header.spec.per_seed, lmbda)

    def measured(self, encoded: Encoded) -> Measured:
        """What a stream is; of its PSNR and score, only what is asked for."""
        settings, quality, score = self.plan.settings, math.inf, math.nan
        if settings.psnr is None and settings.ssimulacra2 is None:
            return Measured(len(encoded.data), quality)
        decoded = self.decoded(encoded.data)
        if settings.psnr is not None:
            shown = np.array(True) if self.empty is None else ~self.empty[..., None]
            quality = psnr(*(np.where(shown, comparable(p), 0) for p in (self.picture, decoded)))
        else:
            score = visual_score(to_rgb8(self.picture), to_rgb8(decoded), self.device)
        return Measured(len(encoded.data), quality, score)

    def decoded(self, data: bytes) -> Picture:
        """The picture of a stream."""
        with open_stream(data, self.device.processor) as stream:
            return stream.picture()

    def assembled(self, header: Header, model: bytes | None) -> tuple[bytes, int]:
        """The stream of a payload, None for nothing, and the bytes of its tile's chunk."""
        buffer, chunk = io.BytesIO(), self.chunk(header, 0, model)
        write_stream(buffer, header, self.plan.software, self.plan.metadata, [chunk])
        return buffer.getvalue(), len(chunk)

    def chunk(self, header: Header, number: int, model: bytes | None) -> bytes:
        """The payload of chunk T of a model, None for nothing."""
        empty = self.empty if header.masked == "transparent" else self.bare.nodata
        exact = None
        if self.bare.exact is not None:
            places = np.flatnonzero(self.bare.exact)
            exact = ExactSamples(places, self.picture.pixels[..., : self.picture.alpha].reshape(-1)[places])
        return encode_tile_chunk(header, number, empty, model, exact)

    @property
    def network_weights(self) -> int:
        """Number of weights of a network that travels in the stream."""
        spec = self.plan.header.spec
        if spec.context.prior:
            return 0
        return spec.context.hidden * sum(input_count(spec, step) for step in range(len(spec.context.steps)))

    @property
    def blob_bytes(self) -> int:
        """Bytes of the metadata that the stream keeps."""
        metadata = self.picture.metadata
        blobs = (metadata.icc, metadata.exif, metadata.xmp) if self.plan.settings.metadata else ()
        return sum(len(blob) for blob in blobs if blob)
