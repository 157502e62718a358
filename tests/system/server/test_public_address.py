"""A server behind a proxy, at a host or in a folder of it: all that it says of itself leads to it from outside."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import parse_qs, urljoin, urlsplit

import pytest
from http_server import Answer, Client, running

from sgicodec.errors import UsageError
from sgicodec.server.app import Settings, application
from sgicodec.server.catalog import Folder
from sgicodec.server.public_address import checked_address
from sgicodec.server.viewer import viewer_folder

ADDRESSES = (
    *(
        "https://pictures.example.org",
        "https://example.org/sgi",
        "http://example.org:8080/a/b",
        "https://a.org/s%C3%A4",
    ),
    *("https://a.org/iiif", "https://a.org/files", "https://a.org/viewer/x"),
)


class Outside:
    """Asks the server as a proxy does: for what lies behind its public address, with the path of it or without."""

    def __init__(self, client: Client, address: str, strips: bool) -> None:
        self._client, self._address, self._strips = client, address, strips

    def __call__(self, url: str, method: str = "GET") -> Answer:
        assert url == self._address or url.startswith(f"{self._address}/"), url
        path = url.removeprefix(self._address if self._strips else "{0.scheme}://{0.netloc}".format(urlsplit(url)))
        return self._client(path or "/", method=method, Host="127.0.0.1:8000")

    def led(self, url: str) -> tuple[str, Answer]:
        """Where redirects lead, and the answer there."""
        for _ in range(5):
            answer = self(url)
            if answer.status not in (303, 307):
                return url, answer
            url = urljoin(url, answer.headers["location"])
        raise AssertionError(f"{url} leads round and round")


@contextmanager
def outside(folder: Path, address: str, strips: bool = True) -> Iterator[Outside]:
    with running(application(Folder(folder), Settings(address=address, viewer=viewer_folder()))) as client:
        yield Outside(client, address, strips)


@pytest.mark.parametrize("address", ADDRESSES)
def test_all_that_is_said_leads_there(folder: Path, address: str) -> None:
    with outside(folder, address) as get:
        _look_around(get, address)


def _look_around(get: Outside, address: str) -> None:
    top, listing = get.led(f"{address}/")
    assert (top, listing.status) == (f"{address}/files/", 200)
    assert get.led(address)[0] == top
    assert get.led(f"{address}/viewer")[0] == f"{address}/viewer/"
    links = {urljoin(top, link) for link in re.findall('href="([^"]*)"', listing.text)}
    assert len(links) > 20
    for link in sorted(links):
        served = "damaged" not in link or link.startswith((f"{address}/files/", f"{address}/viewer/"))
        assert get.led(link.partition("?")[0])[1].status == (200 if served else 500), link
        for shown in parse_qs(urlsplit(link).query).get("file", []):
            assert get(urljoin(link, shown)).status == 200
    deep = urljoin(top, "sub%20dir/")
    assert urljoin(deep, re.findall('href="([^"]*)"', get(deep).text)[0]) == top

    image = f"{address}/iiif/3/rgb8-tiles.sgi"
    assert get.led(image)[0] == f"{image}/info.json"
    assert json.loads(get(f"{image}/info.json").body)["id"] == image
    manifest = get(f"{image}/manifest.json").text
    found = [url for url in re.findall(r'"id":"([^"]*)"', manifest)]
    assert len(found) >= 5
    assert all(url.startswith(image) for url in found)
    drawn = get(f"{image}/full/max/0/default.jpg")
    canonical = re.search(r'<([^>]*)>;rel="canonical"', drawn.headers["link"])
    assert canonical
    assert get(canonical[1]).body == drawn.body


@pytest.mark.parametrize(
    "text", ["example.org/sgi", "/sgi", "", "ftp://a.org", "https://", "https://a.org/?x=1", "https://a.org/#x", "a b"]
)
def test_what_is_no_address(text: str) -> None:
    with pytest.raises(UsageError, match="is no address of a server; it looks like https://"):
        checked_address(text)
