"""A server of streams on a thread of the tests, and requests that reach it exactly as they are written."""

from __future__ import annotations

import http.client
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import uvicorn

from sgicodec.server.run import listening


class Answer(NamedTuple):
    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def text(self) -> str:
        return self.body.decode()


class Client:
    """Sends requests to a port of this machine; paths are sent as they are, dots and all."""

    def __init__(self, port: int) -> None:
        self.port = port

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def __call__(self, path: str, method: str = "GET", **headers: str) -> Answer:
        connection = http.client.HTTPConnection("127.0.0.1", self.port)
        connection._validate_path = lambda url: None  # type: ignore[attr-defined]
        try:
            connection.request(method, path, headers={name.replace("_", "-"): text for name, text in headers.items()})
            answer = connection.getresponse()
            names = {name.lower(): text for name, text in answer.getheaders()}
            return Answer(answer.status, names, answer.read())
        finally:
            connection.close()


def start(*arguments: object) -> tuple[subprocess.Popen[str], str]:
    """A process of the command with these arguments, and the line with the address that it prints."""
    command = [sys.executable, "-m", "sgicodec", *map(str, arguments)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


@contextmanager
def running(app: Any) -> Iterator[Client]:
    """The application on a free port, until the block ends."""
    place = listening("127.0.0.1", 0)
    config = uvicorn.Config(app, log_config=None, ws="none", timeout_graceful_shutdown=_LAST_ANSWERS)
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, args=([place],))
    thread.start()
    try:
        yield Client(place.getsockname()[1])
    finally:
        server.should_exit = True
        thread.join()
        place.close()


_LAST_ANSWERS = 2
"""Seconds that answers get which nobody reads to their end, before the server ends: as in `sgi serve`."""
