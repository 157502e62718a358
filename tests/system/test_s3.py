"""Streams and pictures in S3, by s3fs from a store in this process that counts requests and bytes."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fsspec
import numpy as np
import pytest
from children import HANGS
from click.testing import CliRunner
from repeated_tiles import TILE, repeated_tiles
from s3_server import Store, stored

import sgicodec
from sgicodec.cli.main import cli
from sgicodec.errors import PictureError, StreamError
from sgicodec.remote import upload
from sgicodec.remote.range_file import BLOCK

s3fs = pytest.importorskip("s3fs", reason="S3 is tested by s3fs and moto: pip install 'sgicodec[test]'")

ROWS, COLUMNS = 4, 16
SHAPE = ROWS * TILE, COLUMNS * TILE, 3
REGION = (TILE + 40, 20, TILE // 2, ROWS * TILE - 40)


@pytest.fixture(scope="module")
def data() -> bytes:
    """64 tiles."""
    return repeated_tiles(ROWS, COLUMNS)


@pytest.fixture(scope="module")
def bucket(data: bytes, photo: Path) -> Iterator[Store]:
    files = {"slides/a b.sgi": data, "cut.sgi": data[:-900], "photo.png": photo.read_bytes(), "no.png": b"none"}
    with stored(files) as store:
        yield store


@pytest.fixture
def store(bucket: Store) -> Store:
    bucket.forget()
    return bucket


@pytest.fixture
def sgi(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(cli, [str(argument) for argument in arguments])


def test_a_region_costs_its_tiles(store: Store, data: bytes) -> None:
    """Of sixteen columns of tiles two: one request for each row, all of them at the same time."""
    with sgicodec.open(f"{store.url}/slides/a b.sgi") as stream:
        assert stream.shape == SHAPE
        assert store.heads == 1
        assert len(store.parts) <= 2
        assert store.bytes <= 2 * BLOCK
        store.forget()
        store.meeting = threading.Barrier(ROWS, timeout=HANGS)
        np.testing.assert_array_equal(stream.read(REGION), sgicodec.decode(data, region=REGION))
        assert (store.heads, len(store.parts)) == (0, ROWS)
        assert store.bytes <= ROWS * 2 * BLOCK < len(data) // 2
        store.forget()
        stream.read(REGION)
        assert store.parts == []


def test_all_of_it_takes_few_requests(store: Store, data: bytes) -> None:
    np.testing.assert_array_equal(sgicodec.imread(f"{store.url}/slides/a b.sgi"), sgicodec.decode(data))
    assert len(data) <= store.bytes < len(data) + 3 * BLOCK
    assert len(store.parts) <= 4


def test_commands(store: Store, data: bytes, sgi: Callable[..., Any], tmp_path: Path) -> None:
    url = f"{store.url}/slides/a b.sgi"
    info = json.loads(sgi("info", "--json", url).output)
    assert (info["input"], info["bytes"], info["tiles"]) == (url, len(data), 64)
    assert (store.heads, store.bytes <= 2 * BLOCK) == (1, True)
    store.forget()
    x, y, width, height = REGION
    result = sgi("decode", url, "--region", f"{x},{y},{width},{height}", "--quiet")
    assert result.exit_code == 0, result.output
    assert store.heads == 1
    assert store.bytes <= (ROWS + 1) * 2 * BLOCK < len(data) // 1.5
    part = sgicodec.read(tmp_path / "a b.png").pixels
    np.testing.assert_array_equal(part, sgicodec.decode(data, region=REGION))
    assert "ok, 1024×256" in sgi("verify", url).output
    failed = sgi("verify", f"{store.url}/cut.sgi")
    assert (failed.exit_code, failed.output.count("\n")) == (4, 1)
    assert f"sgi: {store.url}/cut.sgi: " in failed.output


def test_pictures_are_encoded(store: Store, sgi: Callable[..., Any], tmp_path: Path) -> None:
    result = sgi("encode", f"{store.url}/photo.png", "--steps", 2, "--quiet")
    assert result.exit_code == 0, result.output
    assert sgicodec.imread(tmp_path / "photo.sgi").shape == (100, 150, 3)
    with pytest.raises(PictureError, match=r"^s3://pictures/no\.png: (?!s3)"):
        sgicodec.read(f"{store.url}/no.png")


def test_streams_and_pictures_are_written(
    store: Store, sgi: Callable[..., Any], tmp_path: Path, photo: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url, picture = f"{store.url}/written/a b.sgi", f"{store.url}/written/a.png"
    result = sgi("encode", photo, url, "--steps", 2, "--quiet")
    assert result.exit_code == 0, result.output
    refused = sgi("encode", photo, url, "--steps", 2)
    assert (refused.exit_code, refused.output) == (6, f"sgi: {url} exists; give -f to overwrite it\n")
    assert sgi("decode", url, picture, "--quiet").exit_code == 0
    np.testing.assert_array_equal(sgicodec.read(picture).pixels, sgicodec.imread(url))
    assert sgi("compare", url.replace("a b.sgi", "a.png"), picture, "--fail-under", 99).exit_code == 0
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    failed = sgi("decode", url, "s3://nobody/a.png", "--quiet")
    assert (failed.exit_code, failed.output.count("\n")) == (3, 1)
    assert failed.output.startswith("sgi: s3://nobody/a.png: there is no such place; the file is kept in ")


def test_what_is_written_appears_when_it_is_whole(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of three parts the last one fails: the old object stays, and no upload is left open."""
    system = fsspec.filesystem("s3")
    system.pipe_file("pictures/old.sgi", b"old")
    (tmp_path / "new").write_bytes(bytes(11 << 20))
    with monkeypatch.context() as patch:
        patch.setattr("s3fs.S3FileSystem.default_block_size", 5 << 20)
        send = s3fs.S3File._upload_chunk

        def fail(file: s3fs.S3File, final: bool = False) -> Any:
            if final:
                raise OSError(5, "the line is cut")
            return send(file, final)

        patch.setattr(s3fs.S3File, "_upload_chunk", fail)
        with pytest.raises(StreamError, match=r"^s3://pictures/old\.sgi: the line is cut$"):
            upload.send(tmp_path / "new", f"{store.url}/old.sgi", StreamError)
    system.invalidate_cache()
    assert system.cat("pictures/old.sgi") == b"old"
    assert not system.call_s3("list_multipart_uploads", Bucket="pictures").get("Uploads")
    upload.send(tmp_path / "new", f"{store.url}/old.sgi", StreamError)
    system.invalidate_cache()
    assert system.size("pictures/old.sgi") == 11 << 20


@pytest.mark.parametrize("url", ["s3://pictures/none.sgi", "s3://nobody/a.sgi"])
def test_what_is_not_there(store: Store, url: str) -> None:
    with pytest.raises(StreamError, match=f"^{url}: there is no such file$"):
        sgicodec.open(url)


def test_without_a_key(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    fsspec.get_filesystem_class("s3").clear_instance_cache()
    try:
        with pytest.raises(StreamError, match=r"^s3://pictures/cut\.sgi: Unable to locate credentials$"):
            sgicodec.open(f"{store.url}/cut.sgi")
    finally:
        fsspec.get_filesystem_class("s3").clear_instance_cache()
