"""A folder of streams, and a server of it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN
from http_server import Client, running

import sgicodec
from sgicodec.server.app import Settings, application
from sgicodec.server.catalog import Folder


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Golden streams, a wide one of 1100×40 pixels, a damaged one, and what must not be served."""
    top = tmp_path_factory.mktemp("served")
    shown = top / "shown"
    (shown / "sub dir").mkdir(parents=True)
    for name in ("rgb8-tiles", "gray16", "float", "multi8", "gray8-alpha"):
        shutil.copy(GOLDEN / f"{name}.sgi", shown)
    shutil.copy(GOLDEN / "rgba8.sgi", shown / "sub dir" / "räume & <b>.sgi")
    damaged = bytearray((GOLDEN / "rgb8.sgi").read_bytes())
    damaged[len(damaged) // 2] ^= 255
    (shown / "damaged.sgi").write_bytes(damaged)
    x, y = np.meshgrid(np.arange(1100), np.arange(40))
    wide = np.stack([x * 255 // 1099, y * 6, (x // 20 + y // 20) % 2 * 200], axis=2).astype(np.uint8)
    sgicodec.imwrite(shown / "wide.sgi", wide, steps=2)
    (shown / "silicon.sgi").write_bytes(b"\x01\xda" + bytes(600))
    (shown / "notes.txt").write_text("not for others")
    shutil.copy(GOLDEN / "rgb8.sgi", shown / ".hidden.sgi")
    shutil.copy(GOLDEN / "rgb8.sgi", top / "outside.sgi")
    (shown / "link.sgi").symlink_to(top / "outside.sgi")
    (shown / "linked").symlink_to(top)
    (shown / "inner.sgi").symlink_to("rgb8-tiles.sgi")
    (shown / "folder.sgi").mkdir()
    return shown


@pytest.fixture(scope="module")
def get(folder: Path) -> Iterator[Client]:
    """Asks a server of that folder. It ends before other tests begin, which may let clocks jump."""
    with running(application(Folder(folder), Settings(most_pixels=1 << 17, streams=3))) as client:
        yield client
