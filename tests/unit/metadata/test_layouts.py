from __future__ import annotations

import pytest

from sgicodec.metadata.layouts import SampleRange, range_text


@pytest.mark.parametrize(
    ("sample_range", "text"),
    [
        ((0, 255), "0 to 255"),
        ((0.0, 0.123456789), "0 to 0.123457"),
        ((1e7, 1e7 + 1), "10000000 to 10000001"),
        ((4500000.0, 4500000.5), "4500000 to 4500000.5"),
        ((-1e30, 1e30), "-1e+30 to 1e+30"),
        (((0.0, 1e7), (1.0, 1e7 + 2)), "0 to 1, 10000000 to 10000002"),
    ],
)
def test_the_ends_of_a_range_differ(sample_range: SampleRange, text: str) -> None:
    assert range_text(sample_range) == text
