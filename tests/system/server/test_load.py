"""More requests at once than the server answers: who is refused, and what memory the others take."""

from __future__ import annotations

import queue
import re
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from children import HANGS
from http_server import Answer, Client, running, start
from repeated_tiles import TILE, repeated_tiles

from sgicodec.decoder.stream import Stream
from sgicodec.server import app
from sgicodec.server.app import Settings, application
from sgicodec.server.catalog import Folder
from sgicodec.server.drawing import Drawing

MIB = 1 << 20


def in_parallel(get: Client, paths: list[str], answered: Callable[[Answer], None]) -> list[threading.Thread]:
    """A thread for each path, which calls `answered` with what the server says."""
    threads = [threading.Thread(target=lambda path=path: answered(get(path))) for path in paths]  # type: ignore[misc]
    for thread in threads:
        thread.start()
    return threads


def test_requests_beyond_the_queue_are_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One is drawn and two wait, for as long as the others take to be refused."""
    go, drawn = threading.Event(), app.drawn

    def held(stream: Stream, drawing: Drawing) -> bytes:
        assert go.wait(HANGS)
        return drawn(stream, drawing)

    monkeypatch.setattr(app, "drawn", held)
    answers: queue.Queue[Answer] = queue.Queue()
    paths = [f"/iiif/3/wide.sgi/{x},0,8,8/max/0/default.png" for x in range(12)]
    settings = Settings(jobs=1, waiting=2)
    with running(application(Folder(folder), settings)) as get:
        threads = in_parallel(get, paths, answers.put)
        refused = [answers.get(timeout=HANGS) for _ in range(len(paths) - 3)]
        go.set()
        for thread in threads:
            thread.join()
        assert {(answer.status, answer.text) for answer in refused} == {
            (503, "too many requests are waiting; try again\n")
        }
        served = [answers.get_nowait() for _ in range(3)]
        assert [(answer.status, answer.headers["content-type"]) for answer in served] == [(200, "image/png")] * 3
        assert get(paths[0]).status == 200


def peak(pid: int) -> int:
    """Bytes that a process had in memory at most."""
    found = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    assert found
    return int(found[1]) << 10


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads /proc")
def test_memory_has_a_bound(tmp_path: Path) -> None:
    """A stream whose decoded tiles would take 350 MiB, of which 256 are kept, asked for by four clients at once."""
    rows, columns, side, jobs = 72, 64, 8 * TILE, 2
    (tmp_path / "a.sgi").write_bytes(repeated_tiles(rows, columns))
    process, line = start("serve", tmp_path, "--port", 0, "--jobs", jobs, "--streams", 1, "--quiet")
    try:
        found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
        assert found, line
        get = Client(int(found[1]))
        assert get("/iiif/3/a.sgi/0,0,8,8/max/0/default.jpg").status == 200
        before = peak(process.pid)
        corners = [(x, y) for y in range(0, rows * TILE, side) for x in range(0, columns * TILE, side)]
        paths = [f"/iiif/3/a.sgi/{x},{y},{side},{side}/max/0/default.jpg" for x, y in corners]
        with ThreadPoolExecutor(4) as clients:
            assert {answer.status for answer in clients.map(get, paths)} == {200}
        taken = peak(process.pid) - before
    finally:
        process.send_signal(signal.SIGTERM)
        process.communicate()
    in_use = jobs * (side * side * 4 * 4 + (side // TILE + 2) ** 2 * 100_000)
    assert 200 * MIB < taken < 256 * MIB + in_use + 32 * MIB
