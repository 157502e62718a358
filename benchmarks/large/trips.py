"""Peers on large pictures: encode and decode as processes of their own, on the whole picture or on a sample of it."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.large.notes import Job, Notes, Trip, psnr_of
from benchmarks.large.peer import REFUSED
from benchmarks.large.peers import LargePeer
from sgicodec.bench.sgi import Run, run_timed
from sgicodec.errors import SgiError
from sgicodec.image import open_sink, open_source
from sgicodec.model.tile_grid import Rect

__all__ = ["RefusedError", "peer_trip", "sample_of"]

_BLOCK, _BLOCKS = 1024, 4
"""A sample is 4×4 blocks of 1024×1024 pixels."""


class RefusedError(SgiError):
    """A codec does not want a picture."""


def sample_of(picture: Path, job: Job) -> Path:
    """FOLDER/PICTURE-sample.tif: blocks spread evenly over the picture; or the picture, if it has no more pixels."""
    with open_source(picture) as source:
        block = min(_BLOCK, source.width, source.height)
        if source.width * source.height <= (_BLOCKS * block) ** 2:
            return picture
        sample = job.folder / f"{picture.stem}-sample.tif"
        notes = Notes(sample.with_suffix(".json"), job.asked_of(picture) | {"block": block})
        if "made" in notes and sample.is_file():
            return sample
        lefts, tops = (
            [(size - block) * i // (_BLOCKS - 1) for i in range(_BLOCKS)] for size in (source.width, source.height)
        )
        with open_sink(sample, _BLOCKS * block, _BLOCKS * block, "rgb", "uint8") as sink:
            for row, top in enumerate(tops):
                blocks = [source.read(left, top, block, block).pixels for left in lefts]
                sink.write_rows(row * block, np.concatenate(blocks, axis=1))
    notes.put("made", True)
    return sample


def peer_trip(codec: LargePeer, picture: Path, job: Job, size: tuple[int, int], region: Rect | None, rung: int) -> Trip:
    """Codes a picture of `size` columns and rows at a rung, and decodes all of it, then a region. Raises RefusedError;
    SgiError if it fails otherwise.
    """
    asked = job.asked_of(picture) | {"settings": codec.settings(rung), "version": codec.version()}
    asked["region"] = None if region is None else list(region)
    kind = "" if region is None else "whole-"
    notes = Notes(job.folder / f"{picture.stem}-{kind}{codec.name}-{rung:03}.json", asked)
    if "refused" in notes:
        raise RefusedError(notes["refused"])
    try:
        found = notes.once("trip", lambda: _measure(codec.name, picture, rung, job, (0, 0, *size), region))
    except SgiError as error:
        _, refused, reason = str(error).partition(f"failed: {REFUSED}")
        if not refused:
            raise
        notes.put("refused", reason)
        raise RefusedError(reason) from error
    runs: dict[str, Any] = {name: found[name] and Run(*found[name]) for name in ("encode", "decode", "region")}
    return Trip(codec.settings(rung), codec.version(), found["bytes"], found["psnr"], **runs)


def _measure(name: str, picture: Path, rung: int, job: Job, everything: Rect, region: Rect | None) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="sgi-large-", dir=job.folder) as folder:
        coded, decoded = Path(folder, f"coded.{name.rpartition('-')[2]}"), Path(folder, "decoded.tif")

        def run(action: str, *arguments: object) -> Run:
            command = [sys.executable, "-m", "benchmarks.large.peer", action, name]
            return run_timed([*command, *map(str, arguments), "--threads", str(job.workers)])

        def decode(rect: Rect) -> Run:
            return run("decode", coded, decoded, "--region", ",".join(map(str, rect)))

        found: dict[str, Any] = {"encode": run("encode", picture, coded, "--rung", rung)}
        found |= {"bytes": coded.stat().st_size, "decode": decode(everything)}
        found |= {"psnr": psnr_of(picture, decoded), "region": region and decode(region)}
        return found
