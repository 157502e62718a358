"""What a request is refused with: a status of HTTP and one sentence."""

from __future__ import annotations


class Refusal(Exception):
    """A request that gets no picture. `status` is that of HTTP, `text` what the client reads."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status, self.text = status, text
