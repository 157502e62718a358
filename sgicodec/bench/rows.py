"""Results on disk: a tab-separated row for each picture, codec and point, written as soon as measured."""

from __future__ import annotations

import dataclasses
import types
import typing
from dataclasses import dataclass
from pathlib import Path

from sgicodec.errors import UsageError

__all__ = ["Key", "Results", "Row"]

Key = tuple[str, str, str, str, str]


@dataclass(frozen=True)
class Row:
    """One measured point. `codec` to `crc` are its key: equal keys are the same measurement.

    `crc` is the CRC-32 of the 8-bit RGB samples that were coded, in hexadecimal; `memory_mib` the peak
    memory of the codec's process in MiB where the codec has one. `ssimulacra2` and what follows are None where they
    could not be taken, and in files of versions before they were.
    """

    codec: str
    version: str
    settings: str
    picture: str
    crc: str
    width: int
    height: int
    quality: float
    bytes: int
    bpp: float
    psnr: float
    luma_psnr: float
    ssim: float
    ms_ssim: float
    encode_seconds: float
    decode_seconds: float
    memory_mib: float | None
    ssimulacra2: float | None = None
    butteraugli: float | None = None
    flip: float | None = None
    cvvdp: float | None = None

    @property
    def key(self) -> Key:
        return (self.codec, self.version, self.settings, self.picture, self.crc)

    def to_line(self) -> str:
        """Values joined by tabs, in full precision; an unknown value is empty."""
        values = (getattr(self, name) for name in _COLUMNS)
        return "\t".join("" if value is None else str(value) for value in values)

    @classmethod
    def from_line(cls, line: str, columns: int | None = None) -> Row:
        """The inverse of `to_line`, of the first `columns` of them. Raises ValueError if it is not one."""
        texts, known = line.split("\t"), list(_TYPES.items())[:columns]
        if len(texts) != len(known):
            raise ValueError(f"{len(texts)} values instead of {len(known)}")
        typed = zip(known, texts, strict=True)
        return cls(**{name: _parse(text, kind) for (name, kind), text in typed})


_COLUMNS = [field.name for field in dataclasses.fields(Row)]
_TYPES = {name: typing.get_type_hints(Row)[name] for name in _COLUMNS}
_LEAST_COLUMNS = _COLUMNS.index("ssimulacra2")
"""That a file of an older version has."""


def _header(columns: int) -> str:
    """The first line of a file with so many columns."""
    return "\t".join(_COLUMNS[:columns]) + "\n"


def _columns_of(text: str) -> int:
    """How many columns a file has, of this version or of one before; all where it begins in another way."""
    older = (count for count in range(_LEAST_COLUMNS, len(_COLUMNS)) if text.startswith(_header(count)))
    return next(older, len(_COLUMNS))


def _parse(text: str, kind: typing.Any) -> typing.Any:
    if isinstance(kind, types.UnionType):
        return float(text) if text else None
    return kind(text)


class Results:
    """The rows of one file, which grows by `append` and is read again when a run resumes.

    A file without the later columns is read as it is, and gets them when a row is added. A last line without its end,
    left by a run that was cut short, is dropped from the file. Raises UsageError for a file that holds anything else
    than such rows.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows: dict[Key, Row] = {}
        text = path.read_text("utf-8", "replace") if path.exists() else ""
        columns = _columns_of(text)
        self._widen = columns < len(_COLUMNS)
        header = _header(columns)
        if not text.startswith(header) and not header.startswith(text):
            raise UsageError(f"{path} has other columns than this version writes; give another folder")
        complete = text[: text.rfind("\n") + 1] or header
        for number, line in enumerate(complete.split("\n")[1:-1], 2):
            try:
                row = Row.from_line(line, columns)
            except ValueError as error:
                raise UsageError(f"{path}, line {number} is no result: {error}; remove that line") from error
            self.rows[row.key] = row
        if complete != text:
            path.write_text(complete, "utf-8")

    def append(self, row: Row) -> None:
        """Add a row here and at the end of the file."""
        if self._widen:
            lines = (known.to_line() + "\n" for known in self.rows.values())
            self.path.write_text(_header(len(_COLUMNS)) + "".join(lines), "utf-8")
            self._widen = False
        with self.path.open("a", encoding="utf-8") as file:
            file.write(row.to_line() + "\n")
        self.rows[row.key] = row
