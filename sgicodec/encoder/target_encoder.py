"""What all encodes of a picture as one tile to a rate target have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING

from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.tile_encoder import Encoding
from sgicodec.errors import TargetMissedError
from sgicodec.rate_control.side_information import network_bytes
from sgicodec.rate_control.target import Measured, RateTarget

if TYPE_CHECKING:
    from sgicodec.fit.trainer import Progress

__all__ = ["Stream", "TargetEncoder"]

Stream = tuple[Encoded, Measured]


class TargetEncoder(ABC):
    """Takes an encoding to a rate target. ended: whether a fit was ended early."""

    def __init__(self, encoding: Encoding, target: RateTarget) -> None:
        self.encoding, self.target, self.ended = encoding, target, False

    def run(self, on_progress: Callable[[Progress], bool] | None) -> Encoded:
        """Fits and writes. Raises TargetMissedError, with the nearest stream, where the target cannot be reached."""
        if self.encoding.holds_nothing:
            return self.encoding.stream.nothing(self.encoding.lmbda)

        def watch(state: Progress) -> bool:
            self.ended = on_progress is not None and not on_progress(state)
            return not self.ended

        encoded, measured = self._best(watch)
        if self.target.is_missed(measured):
            raise TargetMissedError(self.target.miss_message(measured), encoded)
        return encoded

    @abstractmethod
    def _best(self, on_progress: Callable[[Progress], bool]) -> Stream:
        """The stream that comes nearest to the target."""

    def _extra(self) -> float:
        """Bytes of metadata and of networks that travel in the stream."""
        stream = self.encoding.stream
        return stream.blob_bytes + network_bytes(stream.network_weights)
