"""Results on disk: a tab-separated row for each measured point, written as soon as it is made."""

from __future__ import annotations

import types
import typing
from collections.abc import Hashable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from sgicodec.errors import UsageError

Key = tuple[str, str, str, str, str]


@dataclass(frozen=True)
class Row:
    """One measured point. `codec` to `crc` are its key: equal keys are the same measurement.

    `crc` is the CRC-32 of the 8-bit RGB samples that were coded, in hexadecimal; `memory_mib` the peak
    memory of the codec's process in MiB where the codec has one. `ssimulacra2` and what follows are None where they
    could not be taken.
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
    lpips: float | None = None
    dists: float | None = None

    @property
    def key(self) -> Key:
        return (self.codec, self.version, self.settings, self.picture, self.crc)


class _Keyed(Protocol):
    """A frozen dataclass of numbers and texts, some of which may be None, with a key among them."""

    __dataclass_fields__: typing.ClassVar[dict[str, Any]]

    @property
    def key(self) -> Hashable: ...


R = TypeVar("R", bound=_Keyed)


class RowFile(Generic[R]):
    """The rows of one file, which grows by `append` and is read again when a run resumes; of no file, in memory alone.

    A row is a line of values joined by tabs, in full precision, an unknown value empty. A last line without its end,
    left by a run that was cut short, is dropped when a row is added: another run may still be writing it. Raises
    UsageError for a file that holds anything else than such rows.
    """

    def __init__(self, kind: type[R], path: Path | None) -> None:
        self.path = path
        self.rows: dict[Hashable, R] = {}
        self._kind, hints = kind, typing.get_type_hints(kind)
        self._types: dict[str, Any] = {field.name: hints[field.name] for field in fields(kind)}
        self._complete: str | None = None
        if path is not None:
            self._load(path)

    def _load(self, path: Path) -> None:
        text = path.read_text("utf-8", "replace") if path.exists() else ""
        header = "\t".join(self._types) + "\n"
        if not text.startswith(header) and not header.startswith(text):
            raise UsageError(f"{path} has other columns than this version writes; give another file or folder")
        complete = text[: text.rfind("\n") + 1] or header
        for number, line in enumerate(complete.split("\n")[1:-1], 2):
            try:
                row = self._parsed(line)
            except ValueError as error:
                raise UsageError(f"{path}, line {number} is no result: {error}; remove that line") from error
            self.rows[row.key] = row
        if complete != text:
            self._complete = complete

    def _parsed(self, line: str) -> R:
        """The row of a line. Raises ValueError if it is none."""
        texts = line.split("\t")
        if len(texts) != len(self._types):
            raise ValueError(f"{len(texts)} values instead of {len(self._types)}")
        typed = zip(self._types.items(), texts, strict=True)
        return self._kind(**{name: _parse(text, kind) for (name, kind), text in typed})

    def append(self, row: R) -> None:
        """Add a row here and at the end of the file."""
        if self.path is not None:
            if self._complete is not None:
                self.path.write_text(self._complete, "utf-8")
                self._complete = None
            values = (getattr(row, name) for name in self._types)
            with self.path.open("a", encoding="utf-8") as file:
                file.write("\t".join("" if value is None else str(value) for value in values) + "\n")
        self.rows[row.key] = row


def _parse(text: str, kind: Any) -> Any:
    if isinstance(kind, types.UnionType):
        return typing.get_args(kind)[0](text) if text else None
    return kind(text)


class Results(RowFile[Row]):
    """The rows of `sgi bench`."""

    def __init__(self, path: Path) -> None:
        super().__init__(Row, path)
