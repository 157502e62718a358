"""Pictures coded into a given number of bytes, by sgi or a peer of it."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import Peer
from sgicodec.bench.sgi import SgiCodec
from sgicodec.errors import SgiError

TOLERANCE = 1.02
"""How many times the bytes asked for a peer may take, since its qualities come in steps."""


@dataclass(frozen=True)
class Sized:
    """A picture in about as many bytes as asked for, or `pixels` None and why there is none in `note`."""

    codec: str
    bytes: int
    pixels: Pixels8 | None
    note: str = ""


def coded_to_size(codec: SgiCodec | Peer, pixels: Pixels8, size: int) -> Sized:
    """The best that a codec makes of a picture in `size` bytes: towards that target, or by a search over a peer's
    qualities.
    """
    if isinstance(codec, Peer):
        return _peer_to_size(codec, pixels, size)
    try:
        trip = codec.trip(pixels, ("--size", str(size)))
    except SgiError as error:
        return Sized(codec.name, 0, None, str(error))
    return Sized(codec.name, len(trip.data), trip.pixels)


def _peer_to_size(peer: Peer, pixels: Pixels8, size: int) -> Sized:
    stream = functools.cache(functools.partial(peer.encode, pixels))
    try:
        best = best_within(peer.scale, lambda quality: len(stream(quality)), TOLERANCE * size)
        if best is None:
            least = len(stream(peer.scale[0]))
            return Sized(peer.name, least, None, f"needs {least:,} bytes")
        return Sized(peer.name, len(stream(best)), peer.decode(stream(best)))
    except (OSError, ValueError, RuntimeError) as error:
        return Sized(peer.name, 0, None, str(error))


def best_within(qualities: Sequence[float], size_of: Callable[[float], int], limit: float) -> float | None:
    """The last of the qualities, which stand by rising size, that stays within the limit; None if the first does not.

    By bisection: sizes that fall back in places may hide a later one.
    """
    low, high = -1, len(qualities)  # the first is within, the second is not
    while high - low > 1:
        middle = (low + high) // 2
        if size_of(qualities[middle]) <= limit:
            low = middle
        else:
            high = middle
    return qualities[low] if low >= 0 else None
