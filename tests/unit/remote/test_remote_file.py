"""URLs against a server that counts, one without ranges, and what is said of those that lead nowhere."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from command import done, refused, sgi, told
from range_server import served
from repeated_tiles import TILE

import sgicodec
from sgicodec.errors import CorruptStreamError, MissingExtraError, PictureError, StreamError
from sgicodec.remote.range_file import BLOCK
from sgicodec.remote.remote_file import naming_url, open_url

SIDE = 256


@pytest.fixture(scope="module")
def data() -> bytes:
    """16 tiles of noise and an overview."""
    pixels = np.random.default_rng(1).integers(0, 256, (SIDE, SIDE, 3), np.uint8)
    return sgicodec.encode(pixels, quality=100, texture=False, steps=2, tile=TILE, apron=8, overview=True, rdoq=False)


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_region_costs_its_tiles(data: bytes) -> None:
    expected = sgicodec.decode(data, region=(100, 100, 20, 20))
    with served({"a.sgi": data}) as server, sgicodec.open(f"{server.url}/a.sgi") as stream:
        assert (stream.shape, server.heads) == ((SIDE, SIDE, 3), 1)
        opening = server.bytes, len(server.parts)
        np.testing.assert_array_equal(stream.read((100, 100, 20, 20)), expected)
        assert opening[0] <= 3 * BLOCK
        assert opening[1] <= 3
        assert server.bytes <= len(data) // 2
        assert len(server.parts) <= 5
        asked = len(server.parts)
        stream.read((100, 100, 20, 20))
        assert len(server.parts) == asked


def test_a_server_without_ranges_gives_it_once(data: bytes) -> None:
    with served({"a.sgi": data}, ranges=False) as server, sgicodec.open(f"{server.url}/a.sgi") as stream:
        np.testing.assert_array_equal(stream.read((100, 100, 20, 20)), sgicodec.decode(data, region=(100, 100, 20, 20)))
        np.testing.assert_array_equal(stream.read(), sgicodec.decode(data))
        assert len(server.parts) <= 3  # the first block, the refused range, all of it


def test_commands(data: bytes, tmp_path: Path) -> None:
    with served({"in/a.sgi": data, "cut.sgi": data[:-900]}) as server:
        url = f"{server.url}/in/a.sgi"
        info = told("info", url)
        assert (info["input"], info["bytes"], info["tiles"]) == (url, len(data), 16)
        assert server.bytes <= 2 * BLOCK
        done("decode", url, "--size", "16x", "--quiet")
        done("decode", url, "--size", "16x", "--output-dir", "many", "--quiet")
        np.testing.assert_array_equal(*(sgicodec.read(tmp_path / name).pixels for name in ("a.png", "many/a.png")))
        done("strip", url, "plain.sgi")
        assert (tmp_path / "plain.sgi").read_bytes() == data
        assert "ok, 256×256" in sgi("verify", url).output
        assert refused(4, "verify", f"{server.url}/cut.sgi").startswith(f"sgi: {server.url}/cut.sgi: ")


def test_what_is_not_there() -> None:
    with served({"a.sgi": b"GIF89a"}) as server:
        with pytest.raises(StreamError, match=r"/b\.sgi: there is no such file$"):
            sgicodec.open(f"{server.url}/b.sgi")
        with pytest.raises(PictureError, match=r"/b\.png: there is no such file$"):
            sgicodec.read(f"{server.url}/b.png")
        with pytest.raises(CorruptStreamError, match="no stream of this codec"):
            sgicodec.open(f"{server.url}/a.sgi")
        gone = server.url
    with pytest.raises(StreamError, match=r"/a\.sgi: "):
        sgicodec.open(f"{gone}/a.sgi")
    with pytest.raises(StreamError, match="nosuch"):
        sgicodec.open("nosuch://a/b.sgi")


@pytest.mark.parametrize(
    ("status", "phrase"), [(403, "403 Forbidden"), (401, "401 Unauthorized"), (503, "503 Service")]
)
def test_a_server_that_refuses_says_so(status: int, phrase: str) -> None:
    with served({"a.sgi": b""}) as server:
        server.status = status
        with pytest.raises(StreamError, match=rf"/a\.sgi: its server answers {phrase}"):
            sgicodec.open(f"{server.url}/a.sgi")
        server.status = 410
        with pytest.raises(StreamError, match="there is no such file"):
            sgicodec.open(f"{server.url}/a.sgi")


def test_a_server_that_redirects_in_a_circle() -> None:
    with served({}) as server:
        server.status = 302
        with pytest.raises(StreamError, match=r"/a\.sgi: its server redirects from one address to the next$"):
            sgicodec.open(f"{server.url}/a.sgi")


@pytest.mark.parametrize("hidden", [False, True])
def test_a_server_that_is_silent(hidden: bool) -> None:
    silent: Exception = TimeoutError()
    if hidden:
        silent = FileNotFoundError("https://a/b")
        silent.__cause__ = TimeoutError()
    text = "https://a/b: its server does not answer in time"
    with pytest.raises(StreamError, match=f"^{text}$"), naming_url("https://a/b", StreamError):
        raise silent


def test_missing_libraries(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "fsspec", None)
        with pytest.raises(MissingExtraError, match=r"needs fsspec: pip install 'sgicodec\[remote\]'"):
            open_url("https://example.org/a.sgi")
    monkeypatch.setitem(sys.modules, "s3fs", None)
    monkeypatch.delitem(sys.modules["fsspec.registry"]._registry, "s3", raising=False)  # loaded by another test
    with pytest.raises(MissingExtraError, match="s3fs"):
        open_url("s3://bucket/a.sgi")
