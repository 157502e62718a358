"""The threads that draw: a few at a time, and a queue that has an end."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from sgicodec.server.refusal import Refusal

_Result = TypeVar("_Result")


class Workers:
    """jobs: threads; waiting: requests that may wait for one of them before others are refused with status 503."""

    def __init__(self, jobs: int, waiting: int) -> None:
        self._pool = ThreadPoolExecutor(jobs, "sgi-draw")
        self._room = asyncio.Semaphore(jobs)
        self._most, self._waiting = waiting, 0

    async def run(
        self, work: Callable[[], _Result], is_gone: Callable[[], Awaitable[bool]], admitted: bool = False
    ) -> _Result:
        """What `work` returns. Its turn may come when nobody waits for it any more: then it is not begun. admitted:
        whether the same request had a turn before; it is not refused then, or under load none would ever be answered.
        """
        if self._waiting >= self._most and not admitted:
            raise Refusal(503, "too many requests are waiting; try again")
        self._waiting += 1
        try:
            await self._room.acquire()
        finally:
            self._waiting -= 1
        try:
            if await is_gone():
                raise Refusal(499, "the client went away")
            return await asyncio.get_running_loop().run_in_executor(self._pool, work)
        finally:
            self._room.release()

    def close(self) -> None:
        """Ends the threads when they have rendered what they are at."""
        self._pool.shutdown(cancel_futures=True)
