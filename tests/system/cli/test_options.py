"""Values of options as they are typed."""

from __future__ import annotations

import click
import pytest

from sgicodec.cli.options import BYTES, REGION, SAMPLE_RANGE, SCALE, SIZE


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        (REGION, "0,1,20,30", (0, 1, 20, 30)),
        (REGION, "0, 1, 20, 30", (0, 1, 20, 30)),
        (REGION, "-10,-1,20,30", (-10, -1, 20, 30)),
        (SCALE, "2", 2.0),
        (SCALE, ".5", 0.5),
        (SCALE, "1/4", 0.25),
        (SCALE, "12.5 %", 0.125),
        (SCALE, "0.5x", 0.5),
        (SCALE, "2×", 2.0),
        (SIZE, "512x384", (512, 384, False)),
        (SIZE, "512x384!", (512, 384, True)),
        (SIZE, "512 x 384", (512, 384, False)),
        (SIZE, "512x", (512, None, False)),
        (SIZE, "X384", (None, 384, False)),
        (SIZE, "5×4", (5, 4, False)),
        (BYTES, "20000", 20_000.0),
        (BYTES, "512 B", 512.0),
        (BYTES, "200kB", 200_000.0),
        (BYTES, "200KiB", 204_800.0),
        (BYTES, ".5M", 500_000.0),
        (BYTES, "1.5MiB", 1_572_864.0),
        (BYTES, "2G", 2e9),
        (SAMPLE_RANGE, "0,1", (0.0, 1.0)),
        (SAMPLE_RANGE, "-1.5,2e3", (-1.5, 2000.0)),
    ],
)
def test_reads(kind: click.ParamType, text: str, value: object) -> None:
    assert kind.convert(text, None, None) == value
    assert kind.convert(value, None, None) == value


@pytest.mark.parametrize(
    ("kind", "texts"),
    [
        (REGION, ("", "1,2,3", "1,2,3,4,5", "1,0,-2,2", "a,b,c,d", "1.5,0,2,2")),
        (SCALE, ("", "0", "-1", "1/0", "0%", "%", "x", "1/2%", "50%%", "1/2/3", "inf", "half", "1e5", "9" * 400)),
        (SIZE, ("", "x", "512x!", "!", "5x5!!", "0x5", "5x0", "512", "-5x4", "5x4x3")),
        (BYTES, ("", "0", "0.9", "-5", "kB", "5iB", "5TB", "1e5", "nan", "inf", "5 k B", "9" * 400)),
        (SAMPLE_RANGE, ("", "1", "1,0", "1,1", "nan,1", "0,inf", "a,b", "0,1,2")),
    ],
)
def test_refuses_with_an_example(kind: click.ParamType, texts: tuple[str, ...]) -> None:
    for text in texts:
        with pytest.raises(click.BadParameter, match=", as in "):
            kind.convert(text, None, None)
