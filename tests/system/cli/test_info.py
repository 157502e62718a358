"""`sgi info` as a user types it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from command import done, sgi, told

from sgicodec.decoder.stream import open_stream
from sgicodec.version import __version__


def test_json_agrees_with_the_stream(stream: Path) -> None:
    facts = told("info", stream, "--survey")
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


def test_paper_profile_has_the_papers_table(picture: Path) -> None:
    options = "--profile paper --seeds 6 --per-seed 2 --features 4 --levels 1 --steps 2"
    sgi("encode", picture, *options.split())
    stream = picture.with_suffix(".sgi")
    facts = told("info", stream, "--survey")
    table = facts["paper_parts"]
    assert list(table)[:6] == ["x_a", "f_a", "{s_o, s_a}", "δ", "H", "MLPs"]
    assert abs(table["x_a"] - facts["parts"]["positions"]) <= 1
    assert abs(table["MLPs"] - facts["parts"]["decoders"] - facts["parts"]["context model"]) <= 1
    assert sum(table.values()) == stream.stat().st_size
    text = sgi("info", stream, "--survey").stdout
    assert "6 × 2 = 12 Gaussians" in text
    assert re.findall(r"^  (\S.*?)  +[\d,]+ +[\d.]+ %$", text, re.MULTILINE) == [*table, "total"]


def test_no_tile_is_decoded_without_a_survey(stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    surveyed = told("info", stream, "--survey")
    shown = sgi("info", stream, "--survey").stdout
    monkeypatch.setattr("sgicodec.decoder.stream.Stream.survey", None)
    facts = told("info", stream)
    later = {"seeds", "gaussians", "texture_cells", "symbol_crc"}
    absent = {"overview", "max_error", "graphics_error", "place", "nodata", "magnification", "resolution"}
    assert {name for name, value in facts.items() if value is None} == later | absent
    assert facts.keys() == surveyed.keys()
    assert all(facts[name] == surveyed[name] for name in facts.keys() - later - {"parts"})
    assert list(facts["parts"]) == ["tiles", "container"]
    assert sum(facts["parts"].values()) == facts["bytes"]
    lines = sgi("info", stream).stdout.splitlines()
    assert set(lines[:4]) <= set(shown.splitlines())
    assert not any("Gaussians" in line for line in lines)


def test_many_files(shared: Path, tmp_path: Path) -> None:
    good = [shared / "scene.sgi", shared / "float.sgi"]
    assert re.findall(r"^(\S.*)$", done("info", *good).stdout, re.MULTILINE) == [str(path) for path in good]
    result = sgi("info", good[0], tmp_path / "missing.sgi", good[1], "--json")
    assert result.exit_code == 1
    assert [json.loads(line)["input"] for line in result.stdout.splitlines()] == [str(path) for path in good]
    assert result.stderr.splitlines() == [
        f"sgi: {tmp_path / 'missing.sgi'}: No such file or directory",
        "sgi: 1 of 3 files failed",
    ]
