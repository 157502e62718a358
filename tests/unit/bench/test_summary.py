"""The summary of curves whose relation is known, as numbers, tables, JSON and plots."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from sgicodec.bench.rows import Row
from sgicodec.bench.summary import RATES, Summary, summarise

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


def test_every_measure_is_compared_on_its_own_scale(summary: Summary) -> None:
    sgi = {c.measure: c for c in summary.comparisons if (c.test, c.anchor) == ("sgi", "jpeg")}
    assert sgi["luma_psnr"].rates["a.png 00000000"].low == pytest.approx(steep(0.1) + 1)
    assert sgi["ms_ssim"].rates["a.png 00000000"].low == pytest.approx(steep(0.1) / 2)
    assert sgi["luma_psnr"].mean_rate == pytest.approx(-35)
    assert sgi["ms_ssim"].mean_rate == pytest.approx(-35)


def test_means_are_taken_at_equal_rates(summary: Summary) -> None:
    for bpp in RATES:
        mean, count = summary.means["psnr"]["jpeg"][bpp]
        assert count == 2
        assert mean == pytest.approx((steep(bpp) + flat(bpp)) / 2)


def test_means_say_how_many_pictures_reach_the_rate() -> None:
    points = rows("jpeg", "a.png", steep) + rows("jpeg", "b.png", flat, 3.0)
    means = summarise(points, ["jpeg"]).means["psnr"]["jpeg"]
    assert means[0.15] == (pytest.approx(steep(0.15)), 1)
    assert means[0.5][1] == 2


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


def printed(summary: Summary) -> list[str]:
    from rich.console import Console

    from sgicodec.bench.tables import print_summary

    console = Console(file=io.StringIO(), width=100)
    print_summary(summary, console)
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


def test_tables_say_when_a_mean_lacks_pictures() -> None:
    points = rows("jpeg", "a.png", steep) + rows("jpeg", "b.png", flat)
    points += rows("sgi", "a.png", steep, 0.5) + rows("sgi", "b.png", lambda bpp: 90 + bpp)
    lines = printed(summarise(points, ["sgi", "jpeg"]))
    assert cells(lines, "b.png 00000000") == [["–"]]
    assert cells(lines, "mean, psnr") == [["-50.0 (of 1)"]]


def test_plots_are_drawn_for_each_picture_and_the_mean(summary: Summary, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from sgicodec.bench.plots import write_plots

    paths = write_plots(summary, tmp_path)
    assert [path.name for path in paths] == [
        "rd-mean.png",
        "time.png",
        "rd-a-00000000.png",
        "rd-b-00000000.png",
    ]
    for path in paths:
        assert path.read_bytes().startswith(b"\x89PNG")
    assert paths[2].read_bytes() != paths[3].read_bytes()


def test_a_codec_without_points_is_no_obstacle(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from sgicodec.bench.plots import write_plots

    summary = summarise(rows("jpeg", "a.png", steep), ["sgi", "jpeg"], ["sgi failed"])
    assert len(write_plots(summary, tmp_path)) == 3
    assert cells(printed(summary), "sgi") == [["–"] * len(RATES), ["–"] * 3]


@pytest.fixture
def seen() -> Summary:
    """Scores of 10 to 90 over bpp for jpeg, at 80 % of the rate for sgi; a published curve with PSNR alone."""

    def scored(codec: str, factor: float) -> list[Row]:
        curve = {bpp: 90 - 20 * step for step, bpp in enumerate(reversed(BPPS))}
        return [
            row(codec, "a.png", factor * bpp, steep(bpp), ssimulacra2=score, butteraugli=2 / bpp)
            for bpp, score in curve.items()
        ]

    bare = {"ms_ssim": math.nan, "luma_psnr": math.nan, "encode_seconds": math.nan, "decode_seconds": math.nan}
    published = [replace(point, **bare) for point in rows("coolchic5", "a.png", steep, 0.5)]
    return summarise(scored("sgi", 0.8) + scored("jpeg", 1) + published, ["sgi", "jpeg", "coolchic5"])


def test_perceptual_scores_are_compared(seen: Summary) -> None:
    jpeg = {c.measure: c.rates["a.png 00000000"] for c in seen.comparisons if (c.test, c.anchor) == ("sgi", "jpeg")}
    assert [jpeg[name].value for name in ("psnr", "ssimulacra2", "butteraugli")] == pytest.approx([-20] * 3)
    assert (jpeg["ssimulacra2"].low, jpeg["ssimulacra2"].high) == (20, 85)
    tree = json.loads(json.dumps(seen.to_json(), allow_nan=False))
    assert tree["mean_ssimulacra2_at_bpp"]["jpeg"]["0.2"] == {"ssimulacra2": pytest.approx(30), "pictures": 1}
    assert tree["mean_butteraugli_at_bpp"]["jpeg"]["0.5"] == {"butteraugli": pytest.approx(4), "pictures": 1}


def test_a_published_curve_is_compared_by_what_it_has(seen: Summary) -> None:
    measures = [c.measure for c in seen.comparisons if "coolchic5" in (c.test, c.anchor)]
    assert measures == ["psnr"] * 2
    assert list(seen.means["psnr"]) == ["sgi", "jpeg", "coolchic5"]
    assert list(seen.means["ssimulacra2"]) == ["sgi", "jpeg"]


def test_tables_show_perceptual_scores(seen: Summary) -> None:
    lines = printed(seen)
    assert cells(lines, "a.png 00000000") == [["-20.0", "+60.0"], ["-20.0", "–"], ["-20.0", "–"], ["-50.0"]]
    assert cells(lines, "mean, ssimulacra2") == [["-20.0", "–"]]
    psnr_at, score_at, distance_at, times = cells(lines, "jpeg")
    assert (psnr_at[1], score_at[1], distance_at[3]) == (f"{steep(0.2):.2f}", "30.0", "4.00")
    assert times == ["2.000", "0.500", "–"]
    assert cells(lines, "coolchic5")[-1] == ["–", "–", "–"]


def test_plots_have_a_panel_for_each_measure(seen: Summary, summary: Summary, tmp_path: Path) -> None:
    Image = pytest.importorskip("PIL.Image")
    pytest.importorskip("matplotlib")
    from sgicodec.bench.plots import write_plots

    sizes = {}
    for name, drawn in (("plain", summary), ("seen", seen)):
        (tmp_path / name).mkdir()
        write_plots(drawn, tmp_path / name)
        sizes[name] = [Image.open(tmp_path / name / f"{n}.png").size for n in ("rd-mean", "rd-a-00000000")]
    (mean_width, mean_height), (width, height) = sizes["plain"]
    assert sizes["seen"] == [(3 * mean_width, mean_height), (width, 2 * height)]
