"""The first minutes of a researcher: curves beside other codecs, and the notebook."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from data_files import ROOT, crop
from newcomer import Newcomer

from sgicodec import write

pytestmark = pytest.mark.slow


@pytest.fixture
def researcher(newcomer: Newcomer) -> Newcomer:
    """Has two pictures."""
    for name in ("kodim13", "kodim23"):
        write(crop(name, np.s_[150:342, 100:356]), newcomer.home / f"{name}.png")
    newcomer.install("sgicodec[bench]")
    return newcomer


def test_curves(researcher: Newcomer, reached: Callable[[str], None]) -> None:
    told = researcher.run("sgi", "bench", "kodim13.png", "kodim23.png", "--codecs", "sgi,webp,jxl")
    reached("BD-rates of three codecs and their curves")
    assert "BD-rate" in told
    out = researcher.home / "bench-out"
    rates = {
        (each["test"], each["anchor"], each["measure"]): each["mean_bd_rate_percent"]
        for each in json.loads((out / "summary.json").read_text("utf-8"))["comparisons"]
    }
    assert -60 < rates["sgi", "webp", "ssimulacra2"] < 0
    assert {"results.tsv", "rd-mean.png", "time.png"} <= {path.name for path in out.iterdir()}


def test_the_notebook(researcher: Newcomer, reached: Callable[[str], None], pytestconfig: pytest.Config) -> None:
    if pytestconfig.getoption("--wheel", None) is None:
        pytest.skip("tests/system/test_example_programs.py runs it in the environment of the tests")
    cells = json.loads((ROOT / "examples" / "first_steps.ipynb").read_text("utf-8"))["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    begin = f"import matplotlib, os; matplotlib.use('Agg'); os.chdir({str(ROOT / 'examples')!r})\n"
    (researcher.home / "notebook.py").write_text(begin + code, "utf-8")
    told = researcher.run("python", "notebook.py")
    reached("the notebook, to its end,")
    assert "default profile: " in told
