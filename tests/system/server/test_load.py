"""More requests at once than the server answers: who is refused, and what memory the others take."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from children import HANGS
from http_server import Answer, Client, running

from sgicodec.decoder.stream import Stream
from sgicodec.server import app
from sgicodec.server.app import Settings, application
from sgicodec.server.catalog import Folder
from sgicodec.server.drawing import Drawing


def in_parallel(get: Client, paths: list[str], answered: Callable[[Answer], None]) -> list[threading.Thread]:
    """A thread for each path, which calls `answered` with what the server says."""
    threads = [threading.Thread(target=lambda path=path: answered(get(path))) for path in paths]  # type: ignore[misc]
    for thread in threads:
        thread.start()
    return threads


def test_requests_beyond_the_queue_are_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two are drawn and one waits, for as long as the others take to be refused."""
    go, begun, drawn = threading.Event(), threading.Semaphore(0), app.drawn

    def held(stream: Stream, drawing: Drawing) -> bytes:
        begun.release()
        assert go.wait(HANGS)
        return drawn(stream, drawing)

    monkeypatch.setattr(app, "drawn", held)
    answers: queue.Queue[Answer] = queue.Queue()
    paths = [f"/iiif/3/wide.sgi/{x},0,8,8/max/0/default.png" for x in range(12)]
    settings = Settings(jobs=2, waiting=1)
    with running(application(Folder(folder), settings)) as get:
        threads = in_parallel(get, paths, answers.put)
        refused = [answers.get(timeout=HANGS) for _ in range(len(paths) - 3)]
        assert all(begun.acquire(timeout=HANGS) for _ in range(2))
        assert not begun.acquire(blocking=False)
        go.set()
        for thread in threads:
            thread.join()
        assert {(answer.status, answer.text) for answer in refused} == {
            (503, "too many requests are waiting; try again\n")
        }
        served = [answers.get_nowait() for _ in range(3)]
        assert [(answer.status, answer.headers["content-type"]) for answer in served] == [(200, "image/png")] * 3
        assert get(paths[0]).status == 200
