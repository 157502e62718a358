"""An iterator that computes its next items in a thread of its own (prefetch)."""

from __future__ import annotations

from collections.abc import Iterator
from queue import SimpleQueue
from threading import Thread
from typing import TypeVar

__all__ = ["ahead"]

Item = TypeVar("Item")


def ahead(items: Iterator[Item]) -> Iterator[Item]:
    """The same items, each worked out by a thread of its own while those before it are used.

    Worth it where the items come from native code, which lets other threads run. What `items` raises is raised here.
    """
    queue: SimpleQueue[tuple[Item | None, BaseException | None]] = SimpleQueue()

    def work() -> None:
        try:
            for item in items:
                queue.put((item, None))
            queue.put((None, StopIteration()))
        except BaseException as error:
            queue.put((None, error))

    Thread(target=work, daemon=True).start()
    while True:
        item, error = queue.get()
        if isinstance(error, StopIteration):
            return
        if error is not None:
            raise error
        yield item  # type: ignore[misc]
