"""Variants of whole streams, on a real crop in a few steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.variants import main, whole
from sgicodec import EncodeSettings, encode_picture, read, write
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import UsageError
from sgicodec.picture import Picture

PHOTO = Path(__file__).parents[2] / "data" / "kodim23.png"
SETTINGS = EncodeSettings(lmbda=0.01, steps=30, texture=False)


@pytest.fixture(scope="module")
def crop() -> Picture:
    photo = read(PHOTO)
    return replace(photo, pixels=np.ascontiguousarray(photo.pixels[:96, :128]))


def test_without_a_variant_it_is_what_encode_gives(crop: Picture) -> None:
    assert whole(crop, SETTINGS).encoded.data == encode_picture(crop, SETTINGS).data


def test_variants_reach_the_stream(crop: Picture) -> None:
    for variant, base_cell, prior in (("base_cell=16", 16, 3), ("prior=0", 64, 0)):
        with open_stream(whole(crop, SETTINGS, variant).encoded.data) as stream:
            assert stream.header.spec.base_cell == base_cell
            assert stream.header.spec.context.prior == prior
    split = whole(crop, SETTINGS, "fit.split=30.0").encoded
    assert split.seeds < whole(crop, SETTINGS).encoded.seeds


@pytest.mark.parametrize("variant", ["nonsense=3", "steps", "steps=a b", "fit.nonsense=3"])
def test_what_is_no_variant(crop: Picture, variant: str) -> None:
    with pytest.raises(UsageError, match="variant"):
        whole(crop, SETTINGS, variant)


def test_a_row_for_each_variant(crop: Picture, tmp_path: Path) -> None:
    path = tmp_path / "crop.png"
    write(crop, path)
    arguments = [str(path), "--lmbda", "0.01", "--steps", "20", "--variant", "rdoq=False"]
    lines = CliRunner().invoke(main, arguments, catch_exceptions=False).output.splitlines()
    assert [line.split("\t")[2] for line in lines[1:3]] == ["default", "rdoq=False"]
    assert float(lines[2].split("\t")[9]) > float(lines[1].split("\t")[9])
    assert lines[3].startswith("# rdoq=False at λ = 0.01: J +")
