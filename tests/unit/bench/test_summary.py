"""The summary of curves whose relation is known, as numbers, tables, JSON and plots."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from sgicodec.bench.plots import write_plots
from sgicodec.bench.rows import Row
from sgicodec.bench.summary import Summary, summarise
from sgicodec.bench.tables import print_bytes_at, print_summary

BPPS = (0.1, 0.2, 0.4, 0.8, 1.6)


def row(codec: str, picture: str, bpp: float, psnr: float, **others: float | None) -> Row:
    """A point of a picture of one megapixel. MS-SSIM in dB is half the PSNR, luma PSNR 1 dB above it."""
    values = {"encode_seconds": 2.0, "decode_seconds": 0.5, "memory_mib": None} | others
    return Row(
        codec,
        "1",
        f"bpp={bpp:g}",
        picture,
        "00000000",
        width=1000,
        height=1000,
        quality=bpp,
        bytes=int(bpp * 125000),
        bpp=bpp,
        psnr=psnr,
        luma_psnr=psnr + 1,
        ssim=0.9,
        ms_ssim=1 - 10 ** (-psnr / 20),
        **values,
    )


def rows(codec: str, picture: str, curve: Callable[[float], float], factor: float = 1.0, **others: float) -> list[Row]:
    return [row(codec, picture, factor * bpp, curve(bpp), **others) for bpp in BPPS]


def steep(bpp: float) -> float:
    return 36 + 5 * math.log2(bpp)


def flat(bpp: float) -> float:
    return 30 + 3 * math.log2(bpp)


@pytest.fixture
def summary() -> Summary:
    """Two pictures: jpeg; webp at 80 and 90 % of its rate; sgi at 60 and 70 %."""
    points = rows("jpeg", "a.png", steep) + rows("jpeg", "b.png", flat)
    points += rows("webp", "a.png", steep, 0.8) + rows("webp", "b.png", flat, 0.9)
    points += rows("sgi", "a.png", steep, 0.6, memory_mib=100.0) + rows("sgi", "b.png", flat, 0.7, memory_mib=300.0)
    return summarise(points, ["sgi", "jpeg", "webp"], ["c.png, webp: too large"])


def test_bd_rates_against_every_peer_and_between_peers(summary: Summary) -> None:
    by_psnr = {(c.test, c.anchor): c for c in summary.comparisons if c.measure == "psnr"}
    assert list(by_psnr) == [("sgi", "jpeg"), ("sgi", "webp"), ("webp", "jpeg")]
    sgi = by_psnr["sgi", "jpeg"]
    assert [delta.value for delta in sgi.rates.values()] == pytest.approx([-40, -30])
    assert sgi.mean_rate == pytest.approx(-35)
    assert by_psnr["webp", "jpeg"].mean_rate == pytest.approx(-15)
    assert by_psnr["sgi", "webp"].mean_rate == pytest.approx(100 * ((0.6 / 0.8 + 0.7 / 0.9) / 2 - 1))
    gains = (-5 * math.log2(0.6), -3 * math.log2(0.7))
    assert [delta.value for delta in sgi.qualities.values()] == pytest.approx(gains)
    assert sgi.mean_quality == pytest.approx(sum(gains) / 2)


def test_json_is_strict_and_complete() -> None:
    points = [*rows("jpeg", "a.png", steep), row("sgi", "a.png", 0.5, 60.0)]
    tree = summarise(points, ["sgi", "jpeg"]).to_json()
    tree = json.loads(json.dumps(tree, allow_nan=False))
    assert tree["pictures"] == ["a.png 00000000"]
    assert tree["codecs"] == {"sgi": ["1"], "jpeg": ["1"]}
    assert tree["mean_psnr_at_bpp"]["sgi"]["0.5"] == {"psnr": None, "pictures": 0}
    assert tree["times"]["jpeg"] == {"encode_seconds": 2.0, "decode_seconds": 0.5, "memory_mib": None}
    comparison = tree["comparisons"][0]
    assert comparison["mean_bd_rate_percent"] is None
    assert comparison["pictures"]["a.png 00000000"]["reason"] == "a curve has fewer than two usable points"


def printed(summary: Summary, show: Callable[[Summary, Console], None] = print_summary) -> list[str]:
    console = Console(file=io.StringIO(), width=100)
    show(summary, console)
    return console.file.getvalue().splitlines()


def cells(lines: list[str], first: str) -> list[list[str]]:
    split = [[cell.strip() for cell in line.strip("│┃").split("│")] for line in lines]
    return [line[1:] for line in split if line[0] == first]


def test_tables_show_what_was_computed(summary: Summary) -> None:
    lines = printed(summary)
    assert cells(lines, "a.png 00000000") == [["-40.0", "-25.0"], ["-20.0"]]
    assert cells(lines, "mean, psnr") == [["-35.0", "-23.6"], ["-15.0"]]
    rates, times = cells(lines, "sgi")
    assert rates[0] == f"{(5 * math.log2(0.15 / 0.6) + 36 + 30 + 3 * math.log2(0.15 / 0.7)) / 2:.2f}"
    assert rates[-1] == "–"  # the curve of a.png ends at 0.96 bpp
    assert times == ["2.000", "0.500", "300"]
    assert any("BD-rate in % against jpeg of" in line for line in lines)


def test_bytes_at_a_score() -> None:
    """On the curve, where it begins above and where it ends below."""
    points = [row("sgi", "a.png", bpp, 30, ssimulacra2=score) for bpp, score in ((0.5, 60), (1, 80), (2, 90))]
    points += [row("webp", "a.png", bpp, 30, ssimulacra2=score) for bpp, score in ((0.4, 82), (1, 90))]
    points += [row("jpeg", "a.png", bpp, 30, ssimulacra2=score) for bpp, score in ((0.4, 50), (1, 79))]
    found = summarise(points, ["sgi", "webp", "jpeg"])
    expected = {"sgi": 125000.0, "webp": 50000.0, "jpeg": None}
    tree = json.loads(json.dumps(found.to_json(80), allow_nan=False))
    assert tree["bytes_at_score"] == {"a.png 00000000": pytest.approx(expected)}
    lines = printed(found, lambda summary, console: print_bytes_at(summary, 80, console))
    assert cells(lines, "a.png 00000000") == [["125,000", "50,000", "–"]]
    assert cells(lines, "sgi against it, %") == [["–", "+150.0", "–"]]


def test_intervals_over_pictures() -> None:
    """Of three pictures or more, in tables and JSON."""
    factors = {"a.png": 0.6, "b.png": 0.7, "c.png": 0.8}
    points = [point for name in factors for point in rows("jpeg", name, steep)]
    points += [point for name, factor in factors.items() for point in rows("sgi", name, steep, factor)]
    found = summarise(points, ["sgi", "jpeg"])
    low, high = found.comparisons[0].interval
    assert -40.001 < low < -30 < high < -19.999
    assert cells(printed(found), "mean, psnr") == [[f"-30.0 ({low:+.1f} to {high:+.1f})"]]
    tree = json.loads(json.dumps(found.to_json(), allow_nan=False))
    assert tree["comparisons"][0]["bd_rate_interval_percent"] == [low, high]


def test_plots_of_curves_of_different_qualities(tmp_path: Path) -> None:
    points = rows("jpeg", "a.png", steep) + rows("sgi", "a.png", lambda bpp: steep(bpp) + 40)
    names = [path.name for path in write_plots(summarise(points, ["sgi", "jpeg"]), tmp_path)]
    assert names == ["rd-mean.png", "time.png", "rd-a-00000000.png"]
