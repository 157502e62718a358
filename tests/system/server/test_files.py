"""Streams as files: ranges, versions, and nothing besides."""

from __future__ import annotations

import io
import re
import shutil
from html import unescape
from pathlib import Path

import pytest
from http_server import Client, running
from PIL import Image

import sgicodec
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.server.app import Settings, application
from sgicodec.server.catalog import Folder, ListedStream, Listing
from sgicodec.server.listing_page import listing_page

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
    assert get(FILE, Range="bytes=0-9", If_Range=tag).status == 206
    assert get(FILE, Range="bytes=0-9", If_Range='"another"').status == 200
    assert get(FILE, Range="bytes=9999999-").status == 416


@pytest.mark.parametrize("asked", ["lines=1-2", "bytes=5-2", "bytes=x-", "bytes=-", "bytes", "bytes=0-1,x"])
def test_ranges_that_are_none(get: Client, asked: str) -> None:
    assert get(FILE, Range=asked).status == 200


def test_ranges_beyond_the_end(get: Client) -> None:
    answer = get(FILE, Range="bytes=0-3, 9999999-")
    assert (answer.status, answer.body) == (206, SIGNATURE[:4])


@pytest.mark.parametrize(
    "path",
    [
        *(FILE, "/iiif/3/wide.sgi/info.json", "/iiif/3/wide.sgi/manifest.json", "/dzi/wide.sgi.dzi"),
        *("/iiif/3/wide.sgi/full/20,/0/default.png", "/dzi/wide.sgi_files/3/0_0.jpg"),
    ],
)
def test_conditions(get: Client, path: str) -> None:
    first = get(path)
    tag, date = first.headers["etag"], first.headers["last-modified"]
    for known in (tag, f"W/{tag}", f'"x", W/{tag}', "*"):
        answer = get(path, If_None_Match=known)
        assert (answer.status, answer.body) == (304, b"")
        for name in ("etag", "last-modified", "cache-control", "vary"):
            assert answer.headers.get(name) == first.headers.get(name)
    assert get(path, If_Modified_Since=date).status == 304
    assert get(path, If_None_Match='"x"', If_Modified_Since=date).status == 200
    assert get(path, If_Modified_Since="Thu, 01 Jan 1970 00:00:00 GMT").status == 200


def test_folders_have_a_slash(get: Client) -> None:
    for name in ("sub%20dir", "folder.sgi"):
        answer = get(f"/files/{name}")
        assert (answer.status, answer.headers["location"]) == (307, f"/files/{name}/")
    assert get("/files/linked").status == get("/iiif/3/folder.sgi/info.json").status == 404


@pytest.mark.parametrize(
    "name",
    [
        *("outside.sgi", "../outside.sgi", "..%2Foutside.sgi", "%2e%2e/outside.sgi", "%2e%2e%2foutside.sgi"),
        *("link.sgi", "linked/outside.sgi", "linked%2Foutside.sgi", ".hidden.sgi", "notes.txt"),
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


def rows(page: str) -> dict[str, str]:
    """What a listing says of each stream, by the stream's name."""
    found = (row for row in re.findall("<tr>.*?</tr>", page) if 'class="number"' in row)
    return {unescape(re.findall("<td>([^<]*)</td>", row)[0]): row for row in found}


def test_a_listing_has_sizes_and_thumbnails(get: Client, folder: Path) -> None:
    found = rows(get("/files/").text)
    assert sorted(found) == sorted(
        path.name
        for path in folder.glob("*.sgi")
        if path.is_file() and path.name not in ("link.sgi", "silicon.sgi", ".hidden.sgi")
    )
    for name, row in found.items():
        count = (folder / name).stat().st_size
        size = "damaged"
        if name != "damaged.sgi":
            with sgicodec.open(folder / name) as stream:
                size = f"{stream.width} × {stream.height}"
        assert f">{size}<" in row
        assert (f">{count / 1000:.1f} kB<" if count >= 1000 else f">{count} B<") in row
    wide = re.search('<img src="([^"]+)" width="(\\d+)" height="(\\d+)" loading="lazy"', found["wide.sgi"])
    assert wide
    image = Image.open(io.BytesIO(get(wide[1]).body))
    assert image.size == (int(wide[2]), int(wide[3])) == (128, 5)


def test_a_listing_names_a_stream_that_was_cut(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "cut.sgi").write_bytes((folder / "wide.sgi").read_bytes()[:30])
    assert Folder(tmp_path).listing("") == Listing([], [ListedStream("cut.sgi", 30, None, False)], False)


def test_a_listing_leaves_out_what_leads_nowhere(folder: Path, tmp_path: Path) -> None:
    """A link in a circle keeps nobody from seeing the rest; no route leads to a name with a line break."""
    (tmp_path / "circle.sgi").symlink_to("circle.sgi")
    for name in ("a.sgi", "line\nbreak.sgi"):
        shutil.copy(folder / "wide.sgi", tmp_path / name)
    with running(application(Folder(tmp_path), Settings())) as get:
        answer = get("/files/")
        assert (answer.status, list(rows(answer.text))) == (200, ["a.sgi"])
        assert get("/files/circle.sgi").status == get("/files/line%0Abreak.sgi").status == 404


class Vanishing(Folder):
    """A folder each of whose files is gone as soon as it was found."""

    def find(self, name: str) -> Path:
        path = super().find(name)
        path.unlink()
        return path


@pytest.mark.parametrize("path", ["files/a.sgi", "iiif/3/a.sgi/info.json", "iiif/3/a.sgi/full/max/0/default.jpg"])
def test_a_file_that_goes_meanwhile_is_not_there(folder: Path, tmp_path: Path, path: str) -> None:
    shutil.copy(folder / "wide.sgi", tmp_path / "a.sgi")
    with running(application(Vanishing(tmp_path), Settings())) as get:
        answer = get(f"/{path}")
        assert (answer.status, answer.text) == (404, "the file is gone\n")


def test_a_thumbnail_that_takes_long_is_left_out() -> None:
    page = {
        name: listing_page("", Listing([], [ListedStream("a.sgi", 10**7, size, has_overview)], False), "", True)
        for name, size, has_overview in (
            ("small", (2048, 2048), False),
            ("large", (4096, 4096), False),
            ("large with an overview", (4096, 4096), True),
            ("damaged", None, False),
        )
    }
    assert {name for name in page if "<img" in page[name]} == {"small", "large with an overview"}
    assert "10.0 MB" in page["small"]
    assert ">damaged<" in page["damaged"]


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE"])
def test_nothing_can_be_written(get: Client, method: str) -> None:
    assert get(FILE, method=method).status == 405
