"""The table of efforts: as docs/architecture.md shows it; what a tile without texture takes of it."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from sgicodec.encoder.effort import Effort, Tune
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.picture import Metadata
from sgicodec.rdoq import RdoqSettings

TEXT = (Path(__file__).parents[3] / "docs" / "architecture.md").read_text("utf-8")
TABLES = {"visual": "### For the eye", "psnr": "### Towards least squared error"}


def shown(value: object) -> str:
    """A field as the page shows it."""
    if isinstance(value, bool):
        return "yes" if value else "–"
    return str(value.passes if isinstance(value, RdoqSettings) else value)


@pytest.mark.parametrize("tune", TABLES)
def test_the_page_has_the_table(tune: Tune) -> None:
    part = TEXT.split(TABLES[tune], 1)[1].split("\n#", 1)[0]
    rows = {label: cells.split("|") for label, cells in re.findall(r"^\| `(\w+)` \| (.*) \|$", part, re.MULTILINE)}
    efforts = [EncodeSettings(effort=effort, tune=tune).chosen_effort for effort in range(1, 10)]
    assert rows.keys() == {field.name for field in fields(Effort)}
    for name, cells in rows.items():
        expected = [round(value, 2) if isinstance(value := getattr(one, name), float) else value for one in efforts]
        assert [cell.strip() for cell in cells] == [shown(value) for value in expected], name


def test_a_tile_too_large_for_texture_has_the_fit_without_it() -> None:
    shape = Shape(9000, 8000, "rgb", 3, np.dtype(np.uint8), (0, 255), Metadata(), None)
    plan, plain = (stream_plan(shape, EncodeSettings(tile=0, texture=texture)) for texture in (True, False))
    assert not plan.header.spec.texture
    assert plan.settings.fit_settings() == plain.settings.fit_settings()
