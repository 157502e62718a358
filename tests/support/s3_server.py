"""A store that speaks S3 (moto's, in this process), which counts what it is asked for and gives."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest

BUCKET = "pictures"
_REASON = "S3 is tested by s3fs and moto: pip install 'sgicodec[test]'"


@dataclass
class Store:
    """url: of the bucket; heads: requests for a header; parts: path and bytes asked for, of each answer to GET, and how
    many bytes it had; meeting: where answers to GET wait for each other.
    """

    url: str = f"s3://{BUCKET}"
    heads: int = 0
    parts: list[tuple[str, str, int]] = field(default_factory=list)
    meeting: threading.Barrier | None = None

    @property
    def bytes(self) -> int:
        return sum(count for _, _, count in self.parts)

    def forget(self) -> None:
        """Count from here on."""
        self.heads, self.parts, self.meeting = 0, [], None


class Counting:
    """The store's application, with a count of what goes in and out."""

    def __init__(self, application: Callable[..., Iterable[bytes]], store: Store) -> None:
        self._application, self._store = application, store

    def __call__(self, environment: dict[str, Any], start: Callable[..., Any]) -> Iterable[bytes]:
        method, path = environment["REQUEST_METHOD"], environment["PATH_INFO"]
        body = b"".join(self._application(environment, start))
        if method == "HEAD":
            self._store.heads += 1
        if method == "GET":
            if self._store.meeting:
                self._store.meeting.wait()
            self._store.parts.append((path, environment.get("HTTP_RANGE", ""), len(body)))
        return [body]


@contextlib.contextmanager
def stored(files: dict[str, bytes]) -> Iterator[Store]:
    """A bucket of files on 127.0.0.1, for as long as the context lasts; s3fs finds it by the environment."""
    s3fs, moto = pytest.importorskip("s3fs", reason=_REASON), pytest.importorskip("moto.server", reason=_REASON)
    from werkzeug.serving import make_server

    store = Store()
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    application = Counting(moto.DomainDispatcherApplication(moto.create_backend_app), store)
    server = make_server("127.0.0.1", 0, application, threaded=True)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {
            "AWS_ACCESS_KEY_ID": "key",
            "AWS_SECRET_ACCESS_KEY": "secret",
            "AWS_DEFAULT_REGION": "us-east-1",
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{server.port}",
            "AWS_CONFIG_FILE": "/nonexistent",
            "AWS_EC2_METADATA_DISABLED": "true",
        }.items():
            patch.setenv(name, value)
        s3fs.S3FileSystem.clear_instance_cache()
        system = s3fs.S3FileSystem()
        system.mkdir(BUCKET)
        for name, data in files.items():
            system.pipe_file(f"{BUCKET}/{name}", data)
        s3fs.S3FileSystem.clear_instance_cache()
        store.forget()
        try:
            yield store
        finally:
            s3fs.S3FileSystem.clear_instance_cache()
            server.shutdown()
            thread.join()
            server.server_close()
