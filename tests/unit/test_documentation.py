"""The documentation: links lead somewhere, named programs exist, lines are short, terms are today's."""

from __future__ import annotations

import re
import tomllib
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path

import pytest
from data_files import ROOT

import sgicodec
from benchmarks.__main__ import BENCHMARKS

PAGES = sorted(
    [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("*/README.md"), *ROOT.glob("benchmarks/*/README.md")]
)
LOGS = ROOT / "docs" / "notes"
TODAY = [page for page in PAGES if LOGS not in page.parents]


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def anchors(text: str) -> set[str]:
    """As GitHub makes them of headings, and those that are written out."""
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    plain = (re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings)
    return {*plain, *re.findall(r'<a name="([^"]+)">', text)}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text("utf-8")
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" in target:
            continue
        place, _, anchor = target.partition("#")
        found = page.parent / place if place else page
        assert found.exists(), target
        if anchor:
            assert anchor in anchors(found.read_text("utf-8")), target


@pytest.mark.parametrize("page", TODAY, ids=name_of)
def test_named_programs_exist(page: Path) -> None:
    for module, name in re.findall(r"python -m ([\w.]+)(?: +(\w+))?", page.read_text("utf-8")):
        assert module in ("venv", "pip", "pytest", "mypy", "ruff") or find_spec(module), module
        assert module != "benchmarks" or name in (*BENCHMARKS, "NAME", "", None), name


def test_the_architecture_names_every_room() -> None:
    text_of_tree = (ROOT / "docs" / "architecture.md").read_text("utf-8").split("## What imports what")[0]
    rooms = {path.name for path in (ROOT / "sgicodec").iterdir() if path.is_dir() and (path / "__init__.py").exists()}
    assert [room for room in sorted(rooms) if f"{room}/ " not in text_of_tree] == []


def test_every_dependency_has_its_reason() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    needed = [*project["dependencies"], *(package for packages in extras.values() for package in packages)]
    text = (ROOT / "docs" / "dependencies.md").read_text("utf-8")
    names = {re.split(r"[\[<>=~ ]", package)[0] for package in needed} - {"sgicodec"}
    assert sorted(name for name in names if not re.search(rf"\b{name}\b", text)) == []
    assert sorted(extra for extra in extras if f"| `{extra}` |" not in text) == []


def test_the_api_page_has_every_public_name() -> None:
    text = (ROOT / "docs" / "api.md").read_text("utf-8")
    assert [name for name in sgicodec.__all__ if not re.search(rf"\*\*`{name}\b", text)] == []


def test_the_api_page_has_all_settings_and_their_defaults() -> None:
    table = (ROOT / "docs" / "api.md").read_text("utf-8").split("## Settings")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`.*?) \| (`?[\w\"]+`?) \|", table, re.MULTILINE)
    stated = {name: default.strip("`") for names, default in rows for name in re.findall(r"`(\w+)`", names)}
    real = {field.name: field.default for field in fields(sgicodec.EncodeSettings)}
    assert stated == {name: f'"{value}"' if isinstance(value, str) else str(value) for name, value in real.items()}


@pytest.mark.parametrize("page", TODAY, ids=name_of)
def test_named_files_exist(page: Path) -> None:
    folders = "sgicodec|native|tests|docs|benchmarks|tools|cuda"
    named = re.findall(rf"`((?:{folders})/[\w./-]*)`", page.read_text("utf-8"))
    made_by_tests = {"docs/results/large.tsv"}
    assert [path for path in named if not (ROOT / path).exists() and path not in made_by_tests] == []


def test_the_citation_is_of_this_version_and_names_the_paper() -> None:
    text = (ROOT / "CITATION.cff").read_text("utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    paper = re.search(r"arxiv\.org/abs/([\d.]+)", (ROOT / "README.md").read_text("utf-8"))
    assert paper
    assert re.search(r"^version: (.*)$", text, re.MULTILINE)[1] == project["version"]
    assert re.search(r"^license: (.*)$", text, re.MULTILINE)[1] == project["license"]
    assert f"https://arxiv.org/abs/{paper[1]}" in text


def test_the_first_screen_has_the_figures_of_the_ladder() -> None:
    """Bytes, seconds and milliseconds in README.md, both values of each, are those of the two tables of the log."""
    log = (LOGS / "2026-11-ladder.md").read_text("utf-8").split("**The ladder now**")[-1]
    names = {f"`sgi encode -e {effort}`": f"sgi -e {effort}" for effort in (1, 2)}
    names |= {"`sgi encode`": f"sgi -e {sgicodec.EncodeSettings().effort}", "AVIF": "avif-iq", "JPEG XL": "jxl"}
    rows = re.findall(
        r"^\| (.*?)(?:, .*?)? \| (.*?) \| (.*?) \| (.*?) \|$", (ROOT / "README.md").read_text("utf-8"), re.M
    )
    stated = {names[name]: cells for name, *cells in rows if name in names}
    assert len(stated) == len(names)
    for name, (size, encode, decode) in stated.items():
        printed = re.findall(rf"^\| {name} \| ([\d.]+) \| [\d.]+ \| (\d+) \| (\S+) %", log, re.M)[:2]
        wanted = [list(values) for values in zip(*printed, strict=True)]
        found = [encode.split("; "), decode.split("; "), [value.removesuffix(" %") for value in size.split("; ")]]
        assert found == wanted if size != "0" else found[:2] == wanted[:2], name
