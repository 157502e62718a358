"""Results of the paper's tables on disk: a tab-separated row for each measurement, written as soon as it is made."""

from __future__ import annotations

import types
import typing
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from sgicodec.errors import UsageError

__all__ = ["Key", "PaperResults", "PaperRow"]

Key = tuple[str, str, str, str, str, str]


@dataclass(frozen=True)
class PaperRow:
    """One measured point of a table. The fields up to `options` are its key.

    crc: of the samples that were coded. setting: the row of the table. options: all that decides the result. steps: of
    the fit that it belongs to. psnr: in dB, of the decoded picture, or of the fit where nothing was written and `bytes`
    is None. fit_seconds: by the clock, start of the command included; cpu_seconds: of all processors. parts: bytes by
    name, as `x_a=120;f_a=3000`.
    """

    picture: str
    crc: str
    table: str
    setting: str
    method: str
    options: str
    width: int
    height: int
    seeds: int
    gaussians: int
    steps: int
    bytes: int | None
    psnr: float
    ssim: float | None = None
    lpips: float | None = None
    fit_seconds: float | None = None
    cpu_seconds: float | None = None
    decode_seconds: float | None = None
    decode_cpu_seconds: float | None = None
    peak_mib: float | None = None
    parts: str = ""
    version: str = ""

    @property
    def key(self) -> Key:
        return (self.picture, self.crc, self.table, self.setting, self.method, self.options)

    @property
    def measurement(self) -> tuple[str, str, str]:
        """What was measured, for whichever table and under whichever name of the picture."""
        return (self.crc, self.method, self.options)

    @property
    def pixels(self) -> int:
        return self.width * self.height

    @property
    def part_bytes(self) -> dict[str, float]:
        """`parts` as numbers."""
        pairs = (part.split("=") for part in self.parts.split(";") if part)
        return {name: float(size) for name, size in pairs}

    def to_line(self) -> str:
        """Values joined by tabs; an unknown value is empty."""
        values = (getattr(self, name) for name in _TYPES)
        return "\t".join("" if value is None else str(value) for value in values)

    @classmethod
    def from_line(cls, line: str) -> PaperRow:
        """The inverse of `to_line`. Raises ValueError if it is not one."""
        texts = line.split("\t")
        if len(texts) != len(_TYPES):
            raise ValueError(f"{len(texts)} values instead of {len(_TYPES)}")
        typed = zip(_TYPES.items(), texts, strict=True)
        return cls(**{name: _parse(text, kind) for (name, kind), text in typed})


_TYPES: dict[str, Any] = {field.name: typing.get_type_hints(PaperRow)[field.name] for field in fields(PaperRow)}
_HEADER = "\t".join(_TYPES) + "\n"


def _parse(text: str, kind: Any) -> Any:
    if isinstance(kind, types.UnionType):
        return typing.get_args(kind)[0](text) if text else None
    return kind(text)


class PaperResults:
    """The rows of a file, which grows by `append` and is read again when a run goes on; of no file, in memory alone.

    A last line without its end, left by a run that was cut short, is dropped when a row is added: the file may be one
    that another run adds to. Raises UsageError for a file that holds anything else than such rows.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path
        self.rows: dict[Key, PaperRow] = {}
        self._measured: dict[tuple[str, str, str], PaperRow] = {}
        self._repaired: str | None = None
        if path is not None:
            self._load(path)

    def _load(self, path: Path) -> None:
        text = path.read_text("utf-8", "replace") if path.exists() else ""
        if not text.startswith(_HEADER) and not _HEADER.startswith(text):
            raise UsageError(f"{path} has other columns than this version writes; give another file")
        complete = text[: text.rfind("\n") + 1] or _HEADER
        for number, line in enumerate(complete.split("\n")[1:-1], 2):
            try:
                self._keep(PaperRow.from_line(line))
            except ValueError as error:
                raise UsageError(f"{path}, line {number} is no result: {error}; remove that line") from error
        if complete != text:
            self._repaired = complete

    def _keep(self, row: PaperRow) -> None:
        self.rows[row.key] = row
        self._measured[row.measurement] = row

    def append(self, row: PaperRow) -> None:
        """Adds a row here and at the end of the file."""
        if self.path is not None:
            if self._repaired is not None:
                self.path.write_text(self._repaired, "utf-8")
                self._repaired = None
            with self.path.open("a", encoding="utf-8") as file:
                file.write(row.to_line() + "\n")
        self._keep(row)

    def find(self, key: Key) -> PaperRow | None:
        """The row of this key. What another table measured already is added for this one."""
        picture, crc, table, setting, method, options = key
        same = self._measured.get((crc, method, options))
        if key not in self.rows and same is not None:
            self.append(replace(same, picture=picture, table=table, setting=setting))
        return self.rows.get(key)
