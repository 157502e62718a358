"""sgi on large pictures: whole encode and decode, a region, an overview, each as a process of its own."""

from __future__ import annotations

import io
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.large.notes import Job, Notes, Trip, psnr_of
from sgicodec.bench.sgi import Run, SgiCodec, run_timed
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.device import Device
from sgicodec.model.tile_grid import Axis, Rect, TileGrid

__all__ = ["OVERVIEW", "REGION", "Counting", "decode", "encode", "middle_region", "sgi_trip"]

REGION = 1024
"""Pixels a side of the region that is decoded."""

OVERVIEW = 512
"""Columns of the overview."""

_COMMAND = (sys.executable, "-m", "sgicodec")


class Counting(io.FileIO):
    """A file that counts the bytes that are read of it."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, "rb")
        self.count = 0

    def read(self, size: int | None = -1) -> bytes:
        data = super().read(-1 if size is None else size) or b""
        self.count += len(data)
        return data


def middle_region(grid: TileGrid, side: int = REGION) -> Rect:
    """A square, as far as the picture has room, around the corner of tiles that is nearest to the middle."""
    (x, width), (y, height) = (_middle(axis, side) for axis in (grid.across, grid.down))
    return x, y, width, height


def _middle(axis: Axis, side: int) -> tuple[int, int]:
    """First pixel and number of them along one axis."""
    taken = min(side, axis.length)
    edges = [axis.edge(index) for index in range(1, axis.count)] or [axis.length // 2]
    edge = min(edges, key=lambda edge: abs(2 * edge - axis.length))
    return max(0, min(edge - taken // 2, axis.length - taken)), taken


def sgi_trip(picture: Path, effort: int, job: Job) -> Trip:
    """Encodes the picture to FOLDER/PICTURE-eEFFORT.sgi and decodes it, as far as the notes beside do not have it
    already. Raises SgiError if a command fails.
    """
    stream = job.folder / f"{picture.stem}-e{effort}.sgi"
    asked = job.asked_of(picture) | {"effort": effort, "steps": job.steps, "tile": job.tile}
    notes = Notes(stream.with_suffix(".json"), asked)
    encoded = encode(picture, stream, effort, job, notes)
    with open_stream(stream) as opened:
        region = middle_region(opened.grid)
    if "psnr" not in notes:
        with tempfile.TemporaryDirectory(prefix="sgi-large-", dir=job.folder) as folder:
            whole = Path(folder, "whole.tif")
            notes.put("decode", decode(stream, whole, job))
            notes.put("psnr", psnr_of(picture, whole))
    part = notes.once("region", lambda: _view(stream, job, "--region", ",".join(map(str, region))))
    overview = notes.once("overview", lambda: _view(stream, job, "--size", f"{OVERVIEW}x"))
    settings = f"effort={effort} workers={job.workers}" + (f" steps={job.steps}" if job.steps else "")
    return Trip(
        settings,
        notes["version"],
        stream.stat().st_size,
        notes["psnr"],
        encoded,
        Run(*notes["decode"]),
        Run(*part),
        notes.once("region_bytes", lambda: _bytes_read(stream, job, region=region)),
        Run(*overview),
        notes.once("overview_bytes", lambda: _bytes_read(stream, job, scale=OVERVIEW / opened.width)),
    )


def encode(picture: Path, stream: Path, effort: int, job: Job, notes: Notes) -> Run:
    """`sgi encode`, unless the stream is there and measured. One that was interrupted goes on; its seconds up to the
    last finished tile count, its memory and processor time are not known.
    """
    if "encode" in notes and not stream.is_file():
        notes.clear()
    if "encode" not in notes:
        version, part = SgiCodec().version(), Path(f"{stream}.part")
        spent = _spent(notes, part, version)
        stream.unlink(missing_ok=True)
        notes.put("version", version)
        notes.put("attempt", {"begun": time.time(), "spent": spent})
        options = ["-e", str(effort), "-j", str(job.workers), "--quiet", "--no-verify"]
        options += ["--resume"] if part.exists() else []
        for name, value in (("--steps", job.steps), ("--tile", job.tile)):
            options += [] if value is None else [name, str(value)]
        run = run_timed([*_COMMAND, "encode", str(picture), str(stream), *options])
        notes.put("encode", Run(run.seconds + spent, run.peak, None if spent else run.cpu))
    return Run(*notes["encode"])


def _spent(notes: Notes, part: Path, version: str) -> float:
    """Seconds that went into the tiles of an interrupted encode that the same program can go on with; what another one
    left is removed.
    """
    if part.exists() and "attempt" in notes and notes["version"] == version:
        earlier: dict[str, float] = notes["attempt"]
        return earlier["spent"] + max(0.0, part.stat().st_mtime - earlier["begun"])
    part.unlink(missing_ok=True)
    return 0.0


def decode(stream: Path, out: Path, job: Job, *view: str) -> Run:
    """`sgi decode` of all, or of a view."""
    return run_timed([*_COMMAND, "decode", str(stream), str(out), "-f", "-j", str(job.workers), *view])


def _view(stream: Path, job: Job, *view: str) -> Run:
    with tempfile.TemporaryDirectory(prefix="sgi-large-", dir=job.folder) as folder:
        return decode(stream, Path(folder, "view.tif"), job, *view)


def _bytes_read(path: Path, job: Job, **view: Any) -> int:
    """Bytes of the stream that a view takes."""
    with Counting(path) as file:
        for _ in Stream(file, device=Device(job.workers)).bands(**view):
            pass
        return file.count
