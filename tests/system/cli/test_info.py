"""`sgi info` as a user types it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result

from sgicodec.cli.parts import all_parts
from sgicodec.decoder.stream import open_stream
from sgicodec.image import write
from sgicodec.picture import Picture
from sgicodec.profiles import PAPER
from sgicodec.version import __version__

Run = Callable[..., Result]
ODD = Path(__file__).parents[2] / "data" / "pictures"


def test_json_agrees_with_the_stream(sgi: Run, stream: Path) -> None:
    result = sgi("info", stream, "--json")
    assert result.exit_code == 0
    facts = json.loads(result.stdout)
    size = stream.stat().st_size
    with open_stream(stream) as opened:
        seeds, crc, positions = len(opened.model.layout), opened.symbol_crc, opened.part_bytes["positions"]
    assert facts["input"] == str(stream)
    assert (facts["width"], facts["height"], facts["channels"], facts["channel_count"]) == (48, 32, "rgb", 3)
    assert (facts["sample_type"], facts["sample_range"]) == ("uint8", [0, 255])
    assert (facts["bytes"], facts["bpp"]) == (size, 8 * size / (48 * 32))
    assert (facts["profile"], facts["seeds"], facts["gaussians"]) == ("default", seeds, seeds)
    assert facts["encoder"] == f"{__version__} q50 visual n12"
    assert facts["symbol_crc"] == f"{crc:08x}"
    assert facts["parts"]["positions"] == positions
    assert sum(facts["parts"].values()) == pytest.approx(size)
    assert min(facts["parts"].values()) >= 0
    assert "paper_parts" not in facts


def test_one_screen(sgi: Run, stream: Path) -> None:
    result = sgi("info", stream)
    lines = result.stdout.splitlines()
    parts = json.loads(sgi("info", stream, "--json").stdout)["parts"]
    table = {
        match[1]: match for match in (re.match(r"  (\S.*?)  +([\d,]+) +([\d.]+) %$", line) for line in lines) if match
    }
    assert list(table) == [*parts, "total"]
    for name, size in parts.items():
        assert float(table[name][2].replace(",", "")) == pytest.approx(size, abs=0.51)
    assert sum(float(table[name][3]) for name in parts) == pytest.approx(100, abs=0.05 * len(parts))
    assert len(lines) <= 24
    assert max(map(len, lines[1:])) <= 80
    assert "48×32, rgb, 8 bits" in result.stdout


def test_cells_of_texture_are_counted_by_size(sgi: Run, tmp_path: Path) -> None:
    y, x = np.mgrid[:72, :100]
    waves = 128 + 40 * np.cos(0.8 * x + 0.4 * y) + np.random.default_rng(0).normal(0, 20, (72, 100))
    write(Picture(waves.clip(0, 255).astype(np.uint8)[..., None], "gray", (0.0, 255.0)), tmp_path / "a.png")
    for tile in (0, 64):
        path = tmp_path / f"{tile}.sgi"
        assert sgi("encode", tmp_path / "a.png", path, "--steps", 2, "--tile", tile, "-q", 60).exit_code == 0
        facts = json.loads(sgi("info", path, "--json").stdout)
        with open_stream(path) as opened:
            models = [opened._tiles.decoded(number).model for number in range(opened.grid.count)]
        counts = [model.texture.counts for model in models if model is not None and model.texture is not None]
        cells = {str(side): sum(each[side] for each in counts) for side in (8, 16, 32)}
        assert facts["texture_cells"] == cells
        assert sum(cells.values()) > 0
        assert facts["parts"]["texture"] > 100
        line = next(line for line in sgi("info", path).stdout.splitlines() if line.startswith("  texture "))
        for side, count in cells.items():
            assert (f" {count:,} cells of {side}×{side} pixels" in line) == (count > 0)


def test_no_texture_is_no_line(sgi: Run, picture: Path, tmp_path: Path) -> None:
    sgi("encode", picture, tmp_path / "out.sgi", "--steps", 2, "--no-texture")
    assert json.loads(sgi("info", tmp_path / "out.sgi", "--json").stdout)["texture_cells"] is None
    assert not re.search(r"^  texture ", sgi("info", tmp_path / "out.sgi").stdout, re.MULTILINE)


def test_metadata_is_counted_apart(sgi: Run, tmp_path: Path) -> None:
    sgi("encode", ODD / "icc_profile.png", tmp_path / "out.sgi", "--steps", 2)
    facts = json.loads(sgi("info", tmp_path / "out.sgi", "--json").stdout)
    with open_stream(tmp_path / "out.sgi") as opened:
        icc = opened.metadata.icc
    assert icc is not None
    assert len(icc) < facts["parts"]["ICC profile"] < len(icc) + 10
    assert sum(facts["parts"].values()) == pytest.approx(facts["bytes"])


def test_floats_show_their_range(sgi: Run, shared: Path) -> None:
    assert re.search(r"32-bit float from -?\d+ to \d+", sgi("info", shared / "float.sgi").stdout)


def test_paper_profile_has_the_papers_table(sgi: Run, picture: Path) -> None:
    options = "--profile paper --seeds 6 --per-seed 2 --features 4 --levels 1 --steps 2"
    sgi("encode", picture, *options.split())
    stream = picture.with_suffix(".sgi")
    facts = json.loads(sgi("info", stream, "--json").stdout)
    table = facts["paper_parts"]
    assert list(table)[:6] == ["x_a", "f_a", "{s_o, s_a}", "δ", "H", "MLPs"]
    assert table["x_a"] == facts["parts"]["positions"]
    assert table["MLPs"] == pytest.approx(facts["parts"]["decoders"] + facts["parts"]["context model"])
    assert sum(table.values()) == pytest.approx(stream.stat().st_size)
    shown = re.findall(r"^  (\S.*?)  +[\d,]+ +[\d.]+ %$", sgi("info", stream).stdout, re.MULTILINE)
    assert shown == [*table, "total"]


def test_parts_sum_to_the_size() -> None:
    parts = all_parts({"positions": 10.25, "check": 4.0}, {"signature": 8, "H": 30, "T": 20, "x": 55}, 130)
    assert parts == {"positions": 10.25, "container": 130 - 10.25 - 55, "XMP": 55.0}
    assert PAPER.shown_parts({"positions": 1.0, "decoders": 2.0, "context model": 4.0, "container": 8.0}) == {
        "x_a": 1.0,
        "f_a": 0.0,
        "{s_o, s_a}": 0.0,
        "δ": 0.0,
        "H": 0.0,
        "MLPs": 6.0,
        "container": 8.0,
    }


def test_reads_stdin(sgi: Run, stream: Path) -> None:
    facts = json.loads(sgi("info", "-", "--json", stdin=stream.read_bytes()).stdout)
    assert (facts["input"], facts["bytes"]) == ("stdin", stream.stat().st_size)
