"""A plain HTTP server of bytes in memory, which counts what it is asked for and gives."""

from __future__ import annotations

import contextlib
import re
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


@dataclass
class Served:
    """files: by their paths; parts: path, first byte and number of bytes of each answer to GET; ranges: whether it
    gives parts; status: that all are answered with, instead.
    """

    files: dict[str, bytes]
    ranges: bool = True
    url: str = ""
    parts: list[tuple[str, int, int]] = field(default_factory=list)
    heads: int = 0
    gone: bool = False
    status: int = 0

    @property
    def bytes(self) -> int:
        return sum(count for _, _, count in self.parts)


@contextlib.contextmanager
def served(files: dict[str, bytes], ranges: bool = True) -> Iterator[Served]:
    """Serves files of 127.0.0.1 for as long as the context lasts."""
    record = Served(files, ranges)

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_HEAD(self) -> None:
            record.heads += 1
            self._answer(False)

        def do_GET(self) -> None:
            self._answer(True)

        def _answer(self, with_body: bool) -> None:
            if record.gone:
                self.close_connection = True
                return
            data = record.files.get(self.path.lstrip("/"))
            if data is None or record.status:
                self.send_response(record.status or 404)
                self.send_header("Content-Length", "0")
                self.send_header("Location", self.path)  # of a redirection
                self.end_headers()
                return
            asked = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", "")) if record.ranges else None
            start, stop = (int(asked[1]), int(asked[2] or len(data)) + 1) if asked else (0, len(data))
            part = data[start:stop]
            self.send_response(206 if asked else 200)
            self.send_header("Content-Length", str(len(part)))
            if asked:
                self.send_header("Content-Range", f"bytes {start}-{start + len(part) - 1}/{len(data)}")
            self.end_headers()
            if with_body:
                record.parts.append((self.path, start, len(part)))
                with contextlib.suppress(ConnectionError):
                    self.wfile.write(part)

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        record.url = f"http://127.0.0.1:{server.server_address[1]}"
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        try:
            yield record
        finally:
            record.gone = True  # on open connections too
            server.shutdown()
            thread.join()
