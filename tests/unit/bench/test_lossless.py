"""Lossless and near-lossless rows: which samples codecs take, that all come back, what the command tells."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from rich.console import Console

from sgicodec.bench.command import bench
from sgicodec.bench.lossless import PEERS, LosslessRow, check_error, measure_lossless
from sgicodec.bench.tables import print_lossless
from sgicodec.errors import PictureError
from sgicodec.metrics.psnr import Pixels

pytest.importorskip("imagecodecs")
tifffile = pytest.importorskip("tifffile")


def samples(kind: str, bands: int) -> Pixels:
    """Waves with grain: floats with a fraction, integers beyond 8 bits where the type has more."""
    y, x = np.mgrid[:40, :56]
    planes = [90 + 60 * np.sin(x / 9 + k) * np.cos(y / 7) for k in range(bands)]
    grain = np.random.default_rng(2).normal(0, 5, (40, 56, bands))
    pixels = (np.stack(planes, axis=2) + grain) * (1 if kind == "uint8" else 100)
    return pixels.astype(kind)


TAKEN = {
    ("uint8", 1): {"png", "jpegls", "lerc", "jxl"},
    ("uint8", 3): {"png", "jpegls", "webp", "lerc", "jxl"},
    ("uint16", 1): {"png", "jpegls", "lerc", "jxl"},
    ("uint16", 5): {"lerc", "jxl"},
    ("float32", 1): {"lerc", "jxl"},
}


@pytest.mark.parametrize(("kind", "bands"), TAKEN)
@pytest.mark.parametrize("error", [0.0, 3.0])
def test_peers_keep_to_the_error_and_gain_by_it(kind: str, bands: int, error: float) -> None:
    pixels = samples(kind, bands)
    taking = {name for name, peer in PEERS.items() if peer.takes(pixels, error)}
    assert taking == (TAKEN[kind, bands] if error == 0 else TAKEN[kind, bands] & {"jpegls", "lerc"})
    for peer in (PEERS[name] for name in taking):
        coded = peer.coded(Path("none"), pixels, error)
        check_error(pixels, coded.pixels, error)
        assert 0 < coded.bytes < pixels.nbytes * 1.02
        assert error == 0 or coded.bytes < 0.95 * peer.coded(Path("none"), pixels, 0).bytes


def test_not_a_number_is_a_sample_too() -> None:
    pixels = samples("float32", 1)
    pixels[:3] = np.nan
    assert [name for name, peer in PEERS.items() if peer.takes(pixels, 0)] == ["jxl"]
    check_error(pixels, PEERS["jxl"].coded(Path("none"), pixels, 0).pixels, 0)
    with pytest.raises(PictureError, match="a sample is nan off"):
        check_error(pixels, np.nan_to_num(pixels), 1e9)


def test_samples_that_are_off_are_found() -> None:
    pixels = samples("uint8", 3)
    off = pixels.copy()
    off[3, 4, 1] += 3
    check_error(pixels, off, 3)
    with pytest.raises(PictureError, match="a sample is 3 off, more than 2"):
        check_error(pixels, off, 2)
    with pytest.raises(PictureError, match="of uint16"):
        check_error(pixels, pixels.astype(np.uint16), 0)


def test_a_codec_that_fails_stops_no_other(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "p.tif", samples("uint16", 1))
    lying = replace(PEERS["lerc"], name="lying", near=lambda error: {"level": error + 5})
    told: list[str] = []
    rows, failures = measure_lossless([tmp_path / "p.tif"], [lying, PEERS["png"]], [0], tmp_path, told.append)
    assert [row.codec for row in rows] == ["png"]
    assert len(failures) == 1
    assert failures[0].startswith("p.tif, lying, ±0: a sample is ")
    assert told == [failures[0], "1/1 p.tif 56x40, 1 of uint16: 2 points"]


def test_the_command_measures_files_once(tmp_path: Path) -> None:
    """As they are: 16 bits."""
    source, out = tmp_path / "p.tif", tmp_path / "out"
    tifffile.imwrite(source, samples("uint16", 1))
    arguments = [str(source), "--lossless", "--max-error", "9", "--codecs", "sgi,jpegls", "--efforts", "1", "--json"]
    first = CliRunner().invoke(bench, [*arguments, "--out", str(out)])
    assert first.exit_code == 0, first.exception
    rows = [LosslessRow(**row) for row in json.loads(first.stdout)["rows"]]
    assert [(row.codec, row.max_error) for row in rows] == [
        ("sgi-e1", 0), ("jpegls", 0), ("sgi-e1", 9), ("jpegls", 9)
    ]  # fmt: skip
    assert rows[2].bytes < rows[0].bytes < 40 * 56 * 2
    assert all((row.width, row.height, row.bands) == (56, 40, 1) for row in rows)
    assert all(row.encode_seconds is None or row.encode_seconds > 0 for row in rows)
    assert len((out / "lossless.tsv").read_text().splitlines()) == 1 + len(rows)
    assert CliRunner().invoke(bench, [*arguments, "--out", str(out)]).stdout == first.stdout


def test_tables_compare_the_first_codec_with_each() -> None:
    def row(codec: str, picture: str, size: int) -> LosslessRow:
        return LosslessRow(codec, "1", "", picture, "0", 0.0, 1000, 500, 3, size, 0.25, None)

    sizes = {"sgi a": 100, "png a": 200, "webp a": 125, "sgi b": 100, "png b": 50}
    rows = [row(*name.split(), size) for name, size in sizes.items()]
    rows += [replace(rows[1], max_error=2.0)]
    console = Console(file=io.StringIO(), width=100)
    print_lossless(rows, console)
    lines = [line.strip("│").split("│") for line in console.file.getvalue().splitlines()]
    cells = [[cell.strip() for cell in line] for line in lines]
    assert ["b 0", "0", "100", "50", "–"] in cells
    assert ["png", "0", "2", "+0.0", "0.50", "–"] in cells
    assert ["webp", "0", "1", "-20.0", "0.50", "–"] in cells
    assert ["png", "2", "1", "–", "0.50", "–"] in cells
