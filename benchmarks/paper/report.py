"""The paper's tables in Markdown: its published figures beside measured ones, which are means over pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import mean

from benchmarks.paper import published
from benchmarks.paper.jobs import FACTORS, TABLES, Method
from benchmarks.paper.rows import PaperRow

_MIB = 2**20


@dataclass(frozen=True)
class Mean:
    """Means of the rows of one setting and method. None: some row has no such value."""

    rows: Sequence[PaperRow]

    @property
    def setting(self) -> str:
        return self.rows[0].setting

    @property
    def method(self) -> str:
        return self.rows[0].method

    def of(self, value: Callable[[PaperRow], float | None]) -> float | None:
        """Of a value of each row."""
        values = [value(row) for row in self.rows]
        known = [value for value in values if value is not None]
        return mean(known) if len(known) == len(values) else None

    @property
    def psnr(self) -> float | None:
        return self.of(lambda row: row.psnr)

    @property
    def bytes(self) -> float | None:
        return self.of(lambda row: row.bytes)

    @property
    def minutes(self) -> float | None:
        return self.of(lambda row: None if row.fit_seconds is None else row.fit_seconds / 60)

    @property
    def cpu_minutes(self) -> float | None:
        return self.of(lambda row: None if row.cpu_seconds is None else row.cpu_seconds / 60)


def means(rows: Iterable[PaperRow]) -> list[Mean]:
    """By setting and method, in the order of the rows; of a picture the last row of each counts."""
    last: dict[tuple[str, str], dict[str, PaperRow]] = {}
    for row in rows:
        last.setdefault((row.setting, row.method), {})[row.crc] = row
    return [Mean(list(of_picture.values())) for of_picture in last.values()]


def report(rows: Sequence[PaperRow], each: bool = False) -> str:
    """All tables that have rows, those of each number of steps together; with `each` those of each picture, too."""
    parts: list[str] = []
    for steps in sorted({row.steps for row in rows}, reverse=True):
        together = [row for row in rows if row.steps == steps]
        pictures = list(dict.fromkeys(row.picture for row in together))
        for of in [[name] for name in pictures] if each else [pictures]:
            own = [row for row in together if row.picture in of]
            parts += [f"## {', '.join([*of] if each else ['The paper, repeated'])}, {steps:,} steps", _pictures(own)]
            parts += [_titled(table, [row for row in own if row.table == table]) for table in TABLES]
    return "\n\n".join(part for part in parts if part)


def _titled(table: str, rows: Sequence[PaperRow]) -> str:
    """A table under its title, nothing for one without rows."""
    title, printed = _PRINTED[table]
    return f"### {title}\n\n{printed(rows)}" if rows else ""


def _pictures(rows: Sequence[PaperRow]) -> str:
    """What the tables are means of, and which versions of the program made them."""
    sizes = {row.picture: f"{row.width}×{row.height}" for row in rows if not row.setting.startswith("×")}
    names = ", ".join(f"{name} ({size})" for name, size in sizes.items()) or ", ".join({row.picture for row in rows})
    return f"{names}; sgi {', '.join(sorted({row.version for row in rows}))}."


def _table(headings: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    bars = [" | ".join(line) for line in [headings, *lines]]
    bars.insert(1, "|".join(["---"] * len(headings)))
    return "\n".join(f"|{bar}|" if bar.startswith("---") else f"| {bar} |" for bar in bars)


def _cell(value: float | None, form: str = ".2f", unit: str = "") -> str:
    return "–" if value is None else f"{value:{form}}{unit}"


def _comparison(rows: Sequence[PaperRow]) -> str:
    headings = (
        "method",
        "PSNR",
        "SSIM",
        "LPIPS",
        "minutes",
        "processor minutes",
        "MiB",
        "bpp",
        "Gaussians",
        "pictures",
    )
    lines = [
        (
            *(f"{row.method}, published", f"{row.psnr:.2f}", f"{row.ssim:.4f}", f"{row.lpips:.4f}"),
            *(f"{row.minutes:.2f} (A10)", "–", f"{row.mib:.2f}", "–", "–", "DIV2K"),
        )
        for row in published.COMPARISON
    ]
    lines += [
        (
            *(f"{one.method}, {one.setting}", _cell(one.psnr), _cell(one.of(lambda row: row.ssim), ".4f")),
            *(_cell(one.of(lambda row: row.lpips), ".4f"), _cell(one.minutes), _cell(one.cpu_minutes)),
            *(_mib(one.bytes), _bpp(one), _count(one), f"{len(one.rows)}"),
        )
        for one in means(rows)
    ]
    none = ", ".join(published.WITHOUT_FIGURES)
    return f"{_table(headings, lines)}\n\nOf {none} the paper prints a curve and no figures."


def _mib(size: float | None) -> str:
    return "–" if size is None else f"{size / _MIB:.3f}"


def _count(one: Mean) -> str:
    count = one.of(lambda row: row.gaussians)
    return f"{count:,.0f}" if count and one.method in (Method.PAPER, Method.EXACT) else "–"


def _ablation(rows: Sequence[PaperRow], name: str, table: Mapping[str, published.Ablation], usual: str) -> str:
    """An ablation whose sizes are relative to those of its usual setting. It has the columns that the paper has."""
    found = means(rows)
    anchor = {one.setting: one.bytes for one in found if one.method == Method.PAPER}.get(usual)
    printed = table[usual]
    columns = ["PSNR", *(["size"] if printed.mib else []), *(["minutes"] if printed.minutes else [])]
    headings = [name, *(f"{pictures}: {column}" for pictures in ("FGF2", "ICB") for column in columns)]
    lines = []
    for one in found:
        cells = [one.setting + (", fit, not quantised" if one.method == Method.EXACT else "")]
        row = table[one.setting]
        for index in range(2):
            cells.append(f"{row.psnr[index]:.2f}")
            cells += [f"{row.mib[index] / printed.mib[index]:.2f}"] if row.mib and printed.mib else []
            cells += [f"{row.minutes[index]:.2f}"] if row.minutes else []
        share = one.bytes / anchor if one.bytes and anchor else None
        cells += [_cell(one.psnr), _cell(one.of(lambda row: row.ssim), ".4f"), _cell(share), _cell(one.bytes, ",.0f")]
        lines.append([*cells, _cell(one.minutes), _cell(one.cpu_minutes)])
    headings += ["measured: PSNR", "SSIM", "size", "bytes", "minutes", "processor minutes"]
    return f"{_table(headings, lines)}\n\nSizes are relative to that of {name} = {usual}."


def _per_seed(rows: Sequence[PaperRow]) -> str:
    return _ablation(rows, "K", published.PER_SEED, "10")


def _lambda(rows: Sequence[PaperRow]) -> str:
    return _ablation(rows, "λ", published.LAMBDA, "0.001") + " The paper stores λ = 0 as floats."


def _levels(rows: Sequence[PaperRow]) -> str:
    return _ablation(rows, "M", published.LEVELS, "3")


def _components(rows: Sequence[PaperRow]) -> str:
    names = list(published.COMPONENTS[3_500_000])
    lines = []
    for count, parts in published.COMPONENTS.items():
        total = sum(parts.values())
        shares = [f"{100 * parts[name] / total:.1f} %" for name in names]
        lines.append([f"{count:,}, FGF2, published", *shares, "–", f"{total:.2f} MiB"])
    for one in means(rows):
        total = one.bytes or 0.0
        sizes = [_part(one, name) for name in names]
        shares = [f"{100 * size / total:.1f} % ({size:,.0f})" for size in (*sizes, total - sum(sizes))]
        lines.append([_count(one), *shares, f"{total:,.0f} bytes"])
    return _table(("Gaussians", *names, "rest", "all"), lines)


def _part(one: Mean, name: str) -> float:
    """Mean bytes of a part."""
    return mean(row.part_bytes.get(name, 0.0) for row in one.rows)


def _rate_distortion(rows: Sequence[PaperRow]) -> str:
    (jpeg_bpp, jpeg_psnr), (bpp, psnr) = (published.JPEG_AT_LOW_RATE[name] for name in ("JPEG", "SGI"))
    of_icb = ("a picture of ICB, published", "–", f"{bpp:.3f}", f"{psnr:.2f}", f"{jpeg_bpp:.3f}", f"{jpeg_psnr:.2f}")
    lines: list[Sequence[str]] = [of_icb]
    for name, own in _with_mean(rows):
        found = {(one.setting, one.method): one for one in means(own)}
        for setting in dict.fromkeys(setting for setting, _ in found):
            pair = [found.get((setting, method)) for method in (Method.PAPER, Method.JPEG)]
            cells = [cell for one in pair for cell in (("–", "–") if one is None else (_bpp(one), _cell(one.psnr)))]
            lines.append([name, "–" if pair[0] is None else _count(pair[0]), *cells])
    return _table(("", "Gaussians", "bpp", "PSNR", "JPEG: bpp", "PSNR"), lines)


def _bpp(one: Mean) -> str:
    return _cell(one.of(lambda row: None if row.bytes is None else 8 * row.bytes / row.pixels), ".3f")


def _super_resolution(rows: Sequence[PaperRow]) -> str:
    lines = [
        [f"{name}, DIV2K, published", *(f"{psnr[factor]:.2f}" for factor in FACTORS)]
        for name, psnr in published.SUPER_RESOLUTION.items()
    ]
    for picture, own in _with_mean(rows):
        psnr = {(one.method, one.setting): one.psnr for one in means(own)}
        for method in (Method.BILINEAR, Method.PAPER):
            lines.append([f"{method}, {picture}", *(_cell(psnr.get((method, f"×{factor}"))) for factor in FACTORS)])
    return _table(("", *(f"×{factor}" for factor in FACTORS)), lines)


def _with_mean(rows: Sequence[PaperRow]) -> Iterator[tuple[str, Sequence[PaperRow]]]:
    """Rows by picture, and at last, where there are several, all of them."""
    names = list(dict.fromkeys(row.picture for row in rows))
    for name in names:
        yield name, [row for row in rows if row.picture == name]
    if len(names) > 1:
        yield "mean", rows


def _decode(rows: Sequence[PaperRow]) -> str:
    lines = [
        [f"SGI, {name}, 2K, published", "50,000", f"{milliseconds:.0f} (A10)", "–"]
        for name, milliseconds in published.DECODE_MILLISECONDS.items()
    ]
    for row in rows:
        times = (None if value is None else 1000 * value for value in (row.decode_seconds, row.decode_cpu_seconds))
        name = f"{row.picture}, {row.width}×{row.height}"
        lines.append([name, f"{row.gaussians:,}", *(_cell(value, ".0f") for value in times)])
    return _table(("", "Gaussians", "milliseconds", "of the processors"), lines)


def _exact(rows: Sequence[PaperRow]) -> str:
    lines = []
    for known in published.EXACT:
        spread = f"{known.pixels / known.gaussians:.1f}"
        name = f"{known.method}, {known.pictures}, published"
        lines.append([name, f"{known.gaussians:,}", spread, f"{known.psnr:.2f}", "–", "–"])
    for picture, own in _with_mean(rows):
        for one in means(own):
            pixels = _cell(one.of(lambda row: row.pixels / row.gaussians), ".1f")
            times = (_cell(one.minutes), _cell(one.cpu_minutes))
            lines.append([picture, _count(one), pixels, _cell(one.psnr), *times])
    return _table(("", "Gaussians", "pixels for each", "PSNR", "minutes", "processor minutes"), lines)


_PRINTED: dict[str, tuple[str, Callable[[Sequence[PaperRow]], str]]] = {
    "comparison": ("Comparison at three rates (paper: Table A3)", _comparison),
    "per-seed": ("Gaussians of a seed (paper: Table 3)", _per_seed),
    "lambda": ("λ (paper: Table 4)", _lambda),
    "levels": ("Levels of the pyramid (paper: Table 5)", _levels),
    "components": ("Bytes of each component (paper: Table 6)", _components),
    "rate-distortion": ("Rate and distortion next to JPEG (paper: Figures 4 and 5)", _rate_distortion),
    "super-resolution": (
        "Super-resolution of a picture reduced 8 times, PSNR (paper: Table A2)",
        _super_resolution,
    ),
    "decode": ("Decode time (paper: appendix)", _decode),
    "exact": ("Fits without quantisation (paper: Tables 1, 4 and A3)", _exact),
}
"""Title and printer of each table."""
