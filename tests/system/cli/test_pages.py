"""`sgi encode` of a file that holds several pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tifffile
from command import done, refused

import sgicodec

RAMP = np.add.outer(np.arange(48), np.arange(64)).astype(np.uint8)
PAGES = np.stack([RAMP, 200 - RAMP, 2 * RAMP])


@pytest.fixture
def stack(tmp_path: Path) -> Path:
    tifffile.imwrite(tmp_path / "stack.tif", PAGES, imagej=True, metadata={"axes": "ZYX"})
    return tmp_path / "stack.tif"


def nearest(stream: Path) -> int:
    """The page that a stream shows."""
    return int(np.argmin([np.abs(sgicodec.imread(stream).squeeze().astype(int) - page).mean() for page in PAGES]))


@pytest.mark.parametrize(("page", "told"), [([], "the first of 3 pages; --page chooses another"), (["--page", 2], "")])
def test_other_pages_are_told_of_unless_one_is_chosen(page: list[object], told: str, stack: Path) -> None:
    stream, exact = stack.with_suffix(".sgi"), stack.with_suffix(".exact.sgi")
    for command in (("encode", stack, "--steps", 30), ("refine", stack, stream, exact)):
        assert done(*command, *page, "--quiet").stderr == (f"sgi: {stack}: {told}\n" if told else "")
    assert nearest(stream) == (1 if page else 0)
    np.testing.assert_array_equal(sgicodec.imread(exact).squeeze(), PAGES[1 if page else 0])


def test_workers_read_the_same_page(stack: Path, tmp_path: Path) -> None:
    options = ("--tile", 32, "--steps", 10, "--quiet", "--no-overview", "--page", 3)
    done("encode", stack, tmp_path / "a.sgi", *options, "-j", 1)
    done("encode", stack, tmp_path / "b.sgi", *options, "--cluster", "local:1")
    assert nearest(tmp_path / "b.sgi") == 2
    assert (tmp_path / "a.sgi").read_bytes() == (tmp_path / "b.sgi").read_bytes()


def test_a_page_that_is_not_there(stack: Path) -> None:
    line = refused(2, "encode", stack, "--page", 4)
    assert line == "sgi: there is no page 4; the picture has 3 pages, counted from 1\n"
