"""`sgi serve` and `sgi view` as processes, and what they refuse."""

from __future__ import annotations

import re
import signal
from pathlib import Path

import pytest
from command import refused
from http_server import Client, running, start

from sgicodec.server.app import Settings, application
from sgicodec.server.catalog import ListedFiles


@pytest.mark.parametrize("end", [signal.SIGTERM, signal.SIGINT])
def test_serving_until_a_signal(folder: Path, end: signal.Signals) -> None:
    process, line = start("serve", folder, "--port", 0)
    found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
    assert found, line
    get = Client(int(found[1]))
    assert get("/iiif/3/wide.sgi/full/max/0/default.jpg").status == 200
    assert get("/files/%0anope").status == 404
    process.send_signal(end)
    log, _ = process.communicate()
    assert process.returncode == 0
    lines = [line for line in log.strip().splitlines() if not line.startswith("sgi: the viewer lacks its decoder")]
    assert len(lines) == 2
    assert re.fullmatch(
        r"\S+ \S+ 127.0.0.1 GET /iiif/3/wide.sgi/full/max/0/default.jpg 200 \d+ bytes \d.\d+ s", lines[0]
    )
    assert "GET /files/%0anope 404" in lines[1]


def test_viewing(folder: Path) -> None:
    process, line = start("view", folder / "wide.sgi", folder / "rgb8-tiles.sgi", "--no-browser")
    found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)(/viewer/\?\S+)", line)
    assert found, line
    get = Client(int(found[1]))
    page = get(found[2])
    assert (page.status, page.headers["content-type"]) == (200, "text/html; charset=utf-8")
    assert found[2].endswith("?file=%2Ffiles%2Fwide.sgi&other=%2Ffiles%2Frgb8-tiles.sgi")
    assert get("/files/wide.sgi", Range="bytes=0-9").status == 206
    assert get("/files/gray16.sgi").status == 404
    assert get("/files/wide.sgi", Host="evil.example.org").status == 400
    assert "access-control-allow-origin" not in get("/files/wide.sgi", Origin="https://evil.example.org").headers
    process.send_signal(signal.SIGINT)
    process.communicate()
    assert process.returncode == 0


@pytest.mark.parametrize(
    ("arguments", "status", "text"),
    [
        (("serve", "nowhere"), 2, "No such file"),
        (("serve", __file__), 2, "is no folder"),
        (("view", "nowhere.sgi"), 4, "there is no such file"),
        (("view", "."), 4, "it is a folder"),
    ],
)
def test_refused(arguments: tuple[str, ...], status: int, text: str) -> None:
    assert text in refused(status, *arguments)


def test_a_url_is_passed_on_in_parts(get: Client, folder: Path) -> None:
    data = (folder / "wide.sgi").read_bytes()
    urls = {"far": f"{get.address}/files/wide.sgi", "gone": f"{get.address}/files/absent.sgi"}
    with running(application(ListedFiles({}), Settings(public=False, remote=urls))) as near:
        answer = near("/remote/far", Range="bytes=10-99")
        assert (answer.status, answer.body) == (206, data[10:100])
        assert answer.headers["content-range"] == f"bytes 10-99/{len(data)}"
        assert near("/remote/far", Range="bytes=100-").body == data[100:]
        assert near("/remote/far", Range=f"bytes={len(data)}-").status == 416
        assert near("/remote/far").status == 400
        assert near("/remote/other", Range="bytes=0-9").status == 404
        assert near("/remote/gone", Range="bytes=0-9").status == 500
