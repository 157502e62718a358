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
    memory of the codec's process in MiB where the codec has one.
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

    @property
    def key(self) -> Key:
        return (self.codec, self.version, self.settings, self.picture, self.crc)

    def to_line(self) -> str:
        """Values joined by tabs, in full precision; an unknown value is empty."""
        values = (getattr(self, name) for name in _COLUMNS)
        return "\t".join("" if value is None else str(value) for value in values)

    @classmethod
    def from_line(cls, line: str) -> Row:
        """The inverse of `to_line`. Raises ValueError if it is not one."""
        texts = line.split("\t")
        if len(texts) != len(_COLUMNS):
            raise ValueError(f"{len(texts)} values instead of {len(_COLUMNS)}")
        typed = zip(_TYPES.items(), texts, strict=True)
        return cls(**{name: _parse(text, kind) for (name, kind), text in typed})


_COLUMNS = [field.name for field in dataclasses.fields(Row)]
_TYPES = {name: typing.get_type_hints(Row)[name] for name in _COLUMNS}


def _parse(text: str, kind: typing.Any) -> typing.Any:
    if isinstance(kind, types.UnionType):
        return float(text) if text else None
    return kind(text)


class Results:
    """The rows of one file, which grows by `append` and is read again when a run resumes.

    A last line without its end, left by a run that was cut short, is dropped from the file. Raises
    UsageError for a file that holds anything else than such rows.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows: dict[Key, Row] = {}
        header = "\t".join(_COLUMNS) + "\n"
        text = path.read_text("utf-8", "replace") if path.exists() else ""
        if not text.startswith(header) and not header.startswith(text):
            raise UsageError(f"{path} has other columns than this version writes; give another folder")
        complete = text[: text.rfind("\n") + 1] or header
        for number, line in enumerate(complete.split("\n")[1:-1], 2):
            try:
                row = Row.from_line(line)
            except ValueError as error:
                raise UsageError(f"{path}, line {number} is no result: {error}; remove that line") from error
            self.rows[row.key] = row
        if complete != text:
            path.write_text(complete, "utf-8")

    def append(self, row: Row) -> None:
        """Add a row here and at the end of the file."""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(row.to_line() + "\n")
        self.rows[row.key] = row
