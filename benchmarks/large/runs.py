"""All rows of one large picture: sgi at each effort, then every peer at the same PSNR."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from benchmarks.large.match import TOLERANCE, Probes, match
from benchmarks.large.notes import Job
from benchmarks.large.peers import LargePeer
from benchmarks.large.rows import LargeRow, failed_row, row_of
from benchmarks.large.sgi import middle_region, sgi_trip
from benchmarks.large.trips import RefusedError, peer_trip, sample_of
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import SgiError, UsageError
from sgicodec.image import probe
from sgicodec.model.tile_grid import Rect

__all__ = ["FAILED", "check_picture", "rows_of"]

FAILED = "failed: "
"""How the note of a row begins whose codec ended with an error."""


def check_picture(picture: Path) -> None:
    """Raises UsageError for pictures that not every peer can code."""
    header = probe(picture)
    if header.channels != "rgb" or header.dtype.name != "uint8":
        raise UsageError(
            f"{picture} has {header.channels} of {header.dtype.name}; peers code RGB of 8 bits: convert it, or give "
            '--peers ""'
        )


def rows_of(picture: Path, efforts: Sequence[int], peers: Sequence[LargePeer], job: Job) -> Iterator[LargeRow]:
    """Rows as they are measured. A codec that fails has a row that says so."""
    header = probe(picture)
    size, searches = (header.width, header.height), dict[str, tuple[Probes, Probes]]()
    for effort in efforts:
        try:
            trip = sgi_trip(picture, effort, job)
        except SgiError as error:
            yield failed_row(picture, size, "sgi", effort, f"{FAILED}{error}")
            continue
        yield row_of(picture, size, "sgi", effort, trip, trip.bytes, "")
        with open_stream(job.folder / f"{picture.stem}-e{effort}.sgi") as stream:
            region = middle_region(stream.grid)
        for codec in peers:
            if codec.name not in searches:
                searches[codec.name] = _probes(picture, codec, job, size, region)
            try:
                yield _matched_row(picture, size, codec, effort, trip.psnr, *searches[codec.name])
            except RefusedError as error:
                yield failed_row(picture, size, codec.name, effort, f"refused: {error}")
            except SgiError as error:
                yield failed_row(picture, size, codec.name, effort, f"{FAILED}{error}")


def _probes(picture: Path, codec: LargePeer, job: Job, size: tuple[int, int], region: Rect) -> tuple[Probes, Probes]:
    """Trips of a codec by rung, on a sample and on the whole picture. The region is the same at every effort."""
    whole = Probes(partial(peer_trip, codec, picture, job, size, region))
    sample = sample_of(picture, job)
    if sample == picture:
        return whole, whole
    header = probe(sample)
    return Probes(partial(peer_trip, codec, sample, job, (header.width, header.height), None)), whole


def _matched_row(
    picture: Path, size: tuple[int, int], codec: LargePeer, effort: int, psnr: float, sample: Probes, whole: Probes
) -> LargeRow:
    found = match(psnr, codec.rungs, sample, whole)
    off = found.trip.psnr - psnr
    note = codec.region_note
    if abs(off) > TOLERANCE:
        note += f"; {off:+.3f} dB, no nearer quality found"
    return row_of(picture, size, codec.name, effort, found.trip, found.equal_bytes, note)
