"""`sgi info` as a user types it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.cli.parts import all_parts, whole_bytes
from sgicodec.decoder.stream import open_stream
from sgicodec.image import write
from sgicodec.picture import Picture
from sgicodec.profiles import PAPER
from sgicodec.version import __version__

Run = Callable[..., Result]
ODD = Path(__file__).parents[2] / "data" / "pictures"


def test_json_agrees_with_the_stream(sgi: Run, stream: Path) -> None:
    result = sgi("info", stream, "--survey", "--json")
    assert result.exit_code == 0
    facts = json.loads(result.stdout)
    size = stream.stat().st_size
    with open_stream(stream) as opened:
        seeds, crc, positions = len(opened.model.layout), opened.symbol_crc, opened.part_bytes["positions"]
    assert (facts["schema"], facts["input"]) == (1, str(stream))
    assert (facts["width"], facts["height"], facts["channels"], facts["channel_count"]) == (48, 32, "rgb", 3)
    assert (facts["sample_type"], facts["sample_range"]) == ("uint8", [0, 255])
    assert (facts["bytes"], facts["bpp"]) == (size, 8 * size / (48 * 32))
    assert (facts["profile"], facts["seeds"], facts["gaussians"]) == ("default", seeds, seeds)
    assert facts["encoder"] == f"{__version__} q50 visual n12"
    assert facts["symbol_crc"] == f"{crc:08x}"
    assert abs(facts["parts"]["positions"] - positions) < 1
    assert all(isinstance(part, int) and part >= 0 for part in facts["parts"].values())
    assert sum(facts["parts"].values()) == size
    assert "paper_parts" not in facts


def test_one_screen(sgi: Run, stream: Path) -> None:
    result = sgi("info", stream, "--survey")
    lines = result.stdout.splitlines()
    parts = json.loads(sgi("info", stream, "--survey", "--json").stdout)["parts"]
    table = {
        match[1]: match for match in (re.match(r"  (\S.*?)  +([\d,]+) +([\d.]+) %$", line) for line in lines) if match
    }
    assert list(table) == [*parts, "total"]
    for name, size in parts.items():
        assert int(table[name][2].replace(",", "")) == size
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
        facts = json.loads(sgi("info", path, "--survey", "--json").stdout)
        with open_stream(path) as opened:
            models = [opened.tile_model(number) for number in range(opened.grid.count)]
        counts = [model.texture.counts for model in models if model is not None and model.texture is not None]
        cells = {str(side): sum(each[side] for each in counts) for side in (8, 16, 32)}
        assert facts["texture_cells"] == cells
        assert sum(cells.values()) > 0
        assert facts["parts"]["texture"] > 100
        line = next(line for line in sgi("info", path, "--survey").stdout.splitlines() if line.startswith("  texture "))
        for side, count in cells.items():
            assert (f" {count:,} cells of {side}×{side} pixels" in line) == (count > 0)


def test_no_texture_is_no_line(sgi: Run, picture: Path, tmp_path: Path) -> None:
    sgi("encode", picture, tmp_path / "out.sgi", "--steps", 2, "--no-texture")
    assert json.loads(sgi("info", tmp_path / "out.sgi", "--json").stdout)["texture_cells"] is None
    assert not re.search(r"^  texture ", sgi("info", tmp_path / "out.sgi", "--survey").stdout, re.MULTILINE)


def test_metadata_is_counted_apart(sgi: Run, tmp_path: Path) -> None:
    sgi("encode", ODD / "icc_profile.png", tmp_path / "out.sgi", "--steps", 2)
    facts = json.loads(sgi("info", tmp_path / "out.sgi", "--json").stdout)
    with open_stream(tmp_path / "out.sgi") as opened:
        icc = opened.metadata.icc
    assert icc is not None
    assert len(icc) < facts["parts"]["ICC profile"] < len(icc) + 10
    assert sum(facts["parts"].values()) == facts["bytes"]
    assert list(facts["metadata"]) == ["icc"]
    assert facts["metadata"]["icc"] == facts["parts"]["ICC profile"]


def test_floats_show_their_range(sgi: Run, shared: Path) -> None:
    assert re.search(r"32-bit float from -?\d+ to \d+", sgi("info", shared / "float.sgi").stdout)


def test_paper_profile_has_the_papers_table(sgi: Run, picture: Path) -> None:
    options = "--profile paper --seeds 6 --per-seed 2 --features 4 --levels 1 --steps 2"
    sgi("encode", picture, *options.split())
    stream = picture.with_suffix(".sgi")
    facts = json.loads(sgi("info", stream, "--survey", "--json").stdout)
    table = facts["paper_parts"]
    assert list(table)[:6] == ["x_a", "f_a", "{s_o, s_a}", "δ", "H", "MLPs"]
    assert abs(table["x_a"] - facts["parts"]["positions"]) <= 1
    assert abs(table["MLPs"] - facts["parts"]["decoders"] - facts["parts"]["context model"]) <= 1
    assert sum(table.values()) == stream.stat().st_size
    shown = re.findall(r"^  (\S.*?)  +[\d,]+ +[\d.]+ %$", sgi("info", stream, "--survey").stdout, re.MULTILINE)
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


def test_headers_alone_are_read(sgi: Run, stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    surveyed = json.loads(sgi("info", stream, "--survey", "--json").stdout)
    shown = sgi("info", stream, "--survey").stdout
    monkeypatch.setattr("sgicodec.decoder.stream.open_stream", None)
    facts = json.loads(sgi("info", stream, "--json").stdout)
    later = {"seeds", "gaussians", "texture_cells", "symbol_crc"}
    absent = {"overview", "place", "nodata", "resolution"}
    assert {name for name, value in facts.items() if value is None} == later | absent
    assert facts.keys() == surveyed.keys()
    assert all(facts[name] == surveyed[name] for name in facts.keys() - later - {"parts"})
    assert list(facts["parts"]) == ["tiles", "container"]
    assert sum(facts["parts"].values()) == facts["bytes"]
    lines = sgi("info", stream).stdout.splitlines()
    assert set(lines[:4]) <= set(shown.splitlines())
    assert not any("Gaussians" in line for line in lines)


def test_tiles_are_jumped_over(sgi: Run, picture: Path, tmp_path: Path) -> None:
    """Of a file as of a pipe, with an index."""
    assert sgi("encode", picture, tmp_path / "a.sgi", "--steps", 1, "--tile", 32, "--overview").exit_code == 0
    data = (tmp_path / "a.sgi").read_bytes()
    with open_stream(data) as opened:
        chunks = opened.chunk_bytes
    facts = json.loads(sgi("info", tmp_path / "a.sgi", "--json").stdout)
    assert (facts["tiles"], facts["overview"]) == (2, [3, 2])
    assert facts["parts"] == {
        "tiles": chunks["T"],
        "index": chunks["X"],
        "container": len(data) - chunks["T"] - chunks["X"] - chunks["o"],
        "overview": chunks["o"],
    }
    piped = json.loads(sgi("info", "-", "--json", stdin=data).stdout)
    assert {name: piped[name] for name in ("parts", "bytes")} == {name: facts[name] for name in ("parts", "bytes")}


def test_many_files(sgi: Run, shared: Path, tmp_path: Path) -> None:
    good = [shared / "scene.sgi", shared / "float.sgi"]
    result = sgi("info", *good)
    assert result.exit_code == 0
    assert re.findall(r"^(\S.*)$", result.stdout, re.MULTILINE) == [str(path) for path in good]
    result = sgi("info", good[0], tmp_path / "missing.sgi", good[1], "--json")
    assert result.exit_code == 1
    assert [json.loads(line)["input"] for line in result.stdout.splitlines()] == [str(path) for path in good]
    assert result.stderr.splitlines() == [
        f"sgi: {tmp_path / 'missing.sgi'}: No such file or directory",
        "sgi: 1 of 3 files failed",
    ]


@given(st.dictionaries(st.sampled_from("abcdef"), st.floats(0, 1e6), min_size=1))
def test_whole_bytes_sum_to_their_sum(parts: dict[str, float]) -> None:
    whole = whole_bytes(parts)
    assert list(whole) == list(parts)
    assert sum(whole.values()) == round(sum(parts.values()))
    assert all(abs(whole[name] - size) <= 1 for name, size in parts.items())
