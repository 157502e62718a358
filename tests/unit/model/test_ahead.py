"""Items that are worked out ahead."""

import threading
from collections.abc import Iterator

import pytest

from sgicodec.model.ahead import ahead


def test_same_items_in_order() -> None:
    assert list(ahead(iter([3, None, 1]))) == [3, None, 1]
    assert list(ahead(iter(()))) == []


def test_the_second_is_worked_on_while_the_first_is_used() -> None:
    asked, used = threading.Event(), threading.Event()

    def items() -> Iterator[int]:
        yield 1
        asked.set()
        assert used.wait(20)
        yield 2

    found = ahead(items())
    assert next(found) == 1
    assert asked.wait(20)
    used.set()
    assert next(found) == 2


def test_errors_arrive_where_the_items_are_used() -> None:
    def items() -> Iterator[int]:
        yield 1
        raise ValueError("broken")

    found = ahead(items())
    assert next(found) == 1
    with pytest.raises(ValueError, match="broken"):
        next(found)
