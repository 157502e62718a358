"""Files that are sent to URLs: whole or not at all, and kept here where they cannot be sent."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fsspec
import numpy as np
import pytest
from command import sgi
from data_files import GOLDEN
from fsspec.implementations.memory import MemoryFile
from range_server import served

import sgicodec
from sgicodec.errors import PictureError, StreamError, UsageError
from sgicodec.remote.upload import Upload, check_writable, send


@pytest.fixture
def memory() -> Iterator[Any]:
    """The file system of memory://, empty."""
    system = fsspec.filesystem("memory")
    system.store.clear()
    yield system
    system.store.clear()


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file system that fails when a file is written to its end."""

    def fail(_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(MemoryFile, "commit", fail)


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))


def test_what_was_there_stays_till_all_is_sent(memory: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    memory.pipe("/a", b"old")
    seen: list[bytes] = []

    def write(file: MemoryFile, data: bytes) -> int:
        seen.append(memory.cat("/a"))
        raise OSError(5, "the line is cut")

    monkeypatch.setattr(MemoryFile, "write", write)
    (tmp_path / "a").write_bytes(b"new")
    with pytest.raises(StreamError, match=r"^memory://a: the line is cut$"):
        send(tmp_path / "a", "memory://a", StreamError)
    assert seen == [b"old"]
    assert memory.cat("/a") == b"old"


def test_a_file_that_cannot_be_sent_is_kept(memory: Any, full: None) -> None:
    with Upload("memory://folder/a.png", PictureError) as upload:
        upload.path.write_bytes(b"new")
        with pytest.raises(PictureError, match="No space left on device; the file is kept in ") as caught:
            upload.send()
    kept = Path(str(caught.value).rpartition(" ")[2])
    assert (kept.name, kept.read_bytes()) == ("a.png", b"new")
    kept.unlink()
    kept.parent.rmdir()


@pytest.mark.parametrize("url", ["https://a/b.sgi", "HTTP://a/b", "zip://a::file:///b.zip", "simplecache::s3://a/b"])
def test_what_can_be_read_only(url: str) -> None:
    with pytest.raises(UsageError, match=f"^{re.escape(url)}: .* can be read, not written"):
        check_writable(url)


def test_encode_and_decode(memory: Any, tmp_path: Path, photo: Path) -> None:
    url = "memory://out/photo.sgi"
    options = ("--steps", 2, "--quiet")
    result = sgi("encode", photo, url, *options)
    assert result.exit_code == 0, result.output
    assert sgi("encode", photo, tmp_path / "same.sgi", *options).exit_code == 0
    assert memory.cat("/out/photo.sgi") == (tmp_path / "same.sgi").read_bytes()
    assert (sgi("encode", photo, url, *options).exit_code, sgi("decode", url, url, "-f").exit_code) == (6, 2)
    assert sgi("encode", photo, url, *options, "-f").exit_code == 0
    assert sgi("decode", url, "memory://out/photo.png", "--json").exit_code == 0
    np.testing.assert_array_equal(sgicodec.read("memory://out/photo.png").pixels, sgicodec.imread(url))
    assert {each.name for each in tmp_path.iterdir()} == {"same.sgi"}


def test_refusals_come_before_the_work(photo: Path) -> None:
    with served({"a.png": photo.read_bytes()}) as server:
        url = f"{server.url}/a.sgi"
        for result in (sgi("encode", photo, url), sgi("encode", photo, "-o", url), sgi("encode", photo, url, "-f")):
            assert (result.exit_code, result.output.count("\n")) == (2, 1)
            assert f"sgi: {url}: http:// can be read, not written" in result.output
        result = sgi("decode", GOLDEN / "rgb8.sgi", f"{server.url}/a.png")
        assert (result.exit_code, "can be read, not written" in result.output) == (2, True)
    result = sgi("encode", photo, "memory://photo.png")
    assert (result.exit_code, "does not end in .sgi" in result.output) == (2, True)
