"""Results of the paper's tables on disk."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from sgicodec.bench.rows import RowFile

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


class PaperResults(RowFile[PaperRow]):
    """The rows of the paper's tables. What was measured for one table serves the others."""

    def __init__(self, path: Path | None = None) -> None:
        super().__init__(PaperRow, path)

    def find(self, key: Key) -> PaperRow | None:
        """The row of this key. What another table measured already is added for this one."""
        if key not in self.rows:
            picture, crc, table, setting, *rest = key
            same = [row for row in self.rows.values() if row.measurement == (crc, *rest)]
            if same:
                self.append(replace(same[-1], picture=picture, table=table, setting=setting))
        return self.rows.get(key)
