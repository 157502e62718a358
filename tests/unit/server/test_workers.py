"""Work is done a few at a time, in a queue that has an end."""

from __future__ import annotations

import asyncio
import threading

from sgicodec.server.workers import Workers


async def here() -> bool:
    return False


async def gone() -> bool:
    return True


def test_a_few_at_a_time() -> None:
    most, now, lock = 0, 0, threading.Lock()
    meeting = threading.Barrier(2)

    def work() -> None:
        nonlocal most, now
        with lock:
            now += 1
            most = max(most, now)
        meeting.wait()
        with lock:
            now -= 1

    async def scenario() -> None:
        workers = Workers(2, 100)
        await asyncio.gather(*(workers.run(work, here) for _ in range(12)))
        workers.close()

    asyncio.run(scenario())
    assert most == 2
