"""What runs on large pictures share, and their measurements, written down as they are made: a run of hours can stop."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, cast

from sgicodec.bench.sgi import Run
from sgicodec.files.whole import write_whole
from sgicodec.image import open_source
from sgicodec.metrics.distortion import decibels, squared_error

__all__ = ["Job", "Notes", "Trip", "psnr_of"]


@dataclass(frozen=True)
class Job:
    """The folder for streams and notes, the number of workers or threads, and further options of sgi encode."""

    folder: Path
    workers: int
    steps: int | None = None
    tile: int | None = None

    def asked_of(self, picture: Path) -> dict[str, Any]:
        """What measurements of a picture depend on."""
        return {"picture": picture.name, "picture_bytes": picture.stat().st_size, "workers": self.workers}


@dataclass(frozen=True)
class Trip:
    """One encode and what was decoded of it; each process with seconds, MiB and processor seconds. What a codec does
    not have is None.
    """

    settings: str
    version: str
    bytes: int
    psnr: float
    encode: Run
    decode: Run
    region: Run | None = None
    region_bytes: int | None = None
    overview: Run | None = None
    overview_bytes: int | None = None


T = TypeVar("T")

_BAND = 256
"""Rows that are compared at once."""


class Notes:
    """Values by name in the JSON file `path`. They hold for `asked` alone: if the file is about something else, or
    damaged, it starts empty.
    """

    def __init__(self, path: Path, asked: dict[str, Any]) -> None:
        self._path, self._values = path, {"asked": asked}
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return
        if isinstance(found, dict) and found.get("asked") == asked:
            self._values = found

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def clear(self) -> None:
        """Forget all values."""
        self._values = {"asked": self._values["asked"]}

    def put(self, name: str, value: Any) -> None:
        """Write a value down at once."""
        self._values[name] = value
        write_whole(self._path, json.dumps(self._values, indent=1, ensure_ascii=False).encode())

    def once(self, name: str, measure: Callable[[], T]) -> T:
        """The value of that name; it is measured if it is not there."""
        if name not in self._values:
            self.put(name, measure())
        return cast("T", self._values[name])


def psnr_of(original: Path, decoded: Path) -> float:
    """PSNR in dB over all samples of two picture files, a band of rows at a time."""
    error = 0.0
    with open_source(original) as ours, open_source(decoded) as theirs:
        for y in range(0, ours.height, _BAND):
            window = (0, y, ours.width, min(_BAND, ours.height - y))
            error += squared_error(ours.read(*window), theirs.read(*window))
        return decibels(error, ours.width * ours.height * ours.header.count)
