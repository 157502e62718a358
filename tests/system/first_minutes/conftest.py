"""What the first minutes of all have in common."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from newcomer import Newcomer


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--wheel", type=lambda name: Path(name).resolve(strict=True), help="install this for newcomers")


@pytest.fixture
def newcomer(tmp_path: Path, request: pytest.FixtureRequest) -> Newcomer:
    return Newcomer(tmp_path, request.config.getoption("--wheel", None))


@pytest.fixture
def reached(
    newcomer: Newcomer, request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str]
) -> Callable[[str], None]:
    """Tells what somebody has reached, and when."""

    def tell(what: str) -> None:
        person = request.path.stem.removeprefix("test_").replace("_", " ")
        with capsys.disabled():
            print(f"\n  {person}: {what} after {newcomer.times()}")

    return tell
