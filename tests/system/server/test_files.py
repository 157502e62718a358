"""Streams as files: ranges, versions, and nothing besides."""

from __future__ import annotations

from pathlib import Path

import pytest
from http_server import Client

from sgicodec.bitstream.container import SIGNATURE

FILE = "/files/rgb8-tiles.sgi"


@pytest.mark.parametrize(
    ("asked", "part"),
    [("bytes=0-9", slice(0, 10)), ("bytes=100-", slice(100, None)), ("bytes=-7", slice(-7, None))],
)
def test_ranges(get: Client, folder: Path, asked: str, part: slice) -> None:
    data = (folder / "rgb8-tiles.sgi").read_bytes()
    answer = get(FILE, Range=asked)
    start, stop, _ = part.indices(len(data))
    assert (answer.status, answer.body) == (206, data[part])
    assert answer.headers["content-range"] == f"bytes {start}-{stop - 1}/{len(data)}"


def test_whole_file(get: Client, folder: Path) -> None:
    answer = get(FILE)
    assert (answer.status, answer.body) == (200, (folder / "rgb8-tiles.sgi").read_bytes())
    assert answer.headers["accept-ranges"] == "bytes"
    assert answer.headers["content-type"] == "image/x-sgicodec"
    head = get(FILE, method="HEAD")
    assert (head.status, head.body, head.headers["content-length"]) == (200, b"", str(len(answer.body)))


def test_versions(get: Client) -> None:
    tag = get(FILE).headers["etag"]
    assert get(FILE, If_None_Match=tag).status == 304
    assert get(FILE, Range="bytes=0-9", If_Range=tag).status == 206
    assert get(FILE, Range="bytes=0-9", If_Range='"another"').status == 200
    assert get(FILE, Range="bytes=9999999-").status == 416


@pytest.mark.parametrize(
    "name",
    [
        *("outside.sgi", "../outside.sgi", "..%2Foutside.sgi", "%2e%2e/outside.sgi", "%2e%2e%2foutside.sgi"),
        *("link.sgi", "linked/outside.sgi", "linked%2Foutside.sgi", ".hidden.sgi", "notes.txt", "folder.sgi"),
        *("sub dir/../../outside.sgi", "sub%20dir/..%2f..%2foutside.sgi", "%2Fetc%2Fpasswd", "/etc/passwd"),
        *(
            "rgb8-tiles.sgi%00",
            "%00",
            "rgb8-tiles.sgi/",
            "silicon.sgi",
            ".",
            "..",
            "..\\outside.sgi",
            "..%5Coutside.sgi",
        ),
        *("%252e%252e%252foutside.sgi", "./rgb8-tiles.sgi", "a" * 5000 + ".sgi", "%ff%fe.sgi", "linked/"),
    ],
)
def test_nothing_else_is_served(get: Client, name: str) -> None:
    for path in (f"/files/{name}", f"/iiif/3/{name}/full/max/0/default.jpg", f"/iiif/3/{name}/info.json"):
        answer = get(path.replace(" ", "%20"))
        assert answer.status in (400, 404), path
        assert SIGNATURE not in answer.body
    for path in (f"/dzi/{name}.dzi", f"/dzi/{name}_files/0/0_0.jpg"):
        assert get(path.replace(" ", "%20")).status in (400, 404), path


def test_listing(get: Client) -> None:
    top = get("/files/").text
    assert [name for name in ("rgb8-tiles.sgi", "sub%20dir/", "inner.sgi") if name not in top] == []
    assert [name for name in ("hidden", "notes", "outside", "link", "silicon") if name in top] == []
    inside = get("/files/sub%20dir/").text
    assert "räume &amp; &lt;b&gt;.sgi" in inside
    assert "<b>" not in inside
    assert "/iiif/3/sub%20dir%2Fr%C3%A4ume%20%26%20%3Cb%3E.sgi/info.json" in inside
    assert get("/").headers["location"] == "/files/"


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE"])
def test_nothing_can_be_written(get: Client, method: str) -> None:
    assert get(FILE, method=method).status == 405
