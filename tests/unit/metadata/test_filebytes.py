from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sgicodec.metadata.filebytes import FileBytes

PLACE = st.none() | st.integers(-40, 40)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.binary(max_size=30), start=PLACE, stop=PLACE)
def test_slices_are_those_of_bytes(tmp_path: Path, data: bytes, start: int | None, stop: int | None) -> None:
    (tmp_path / "x").write_bytes(data)
    with (tmp_path / "x").open("rb") as file:
        view = FileBytes(file)
        assert len(view) == len(data)
        assert view[start:stop] == data[start:stop]
        if start is not None and -len(data) <= start < len(data):
            assert view[start] == data[start]
        elif start is not None:
            with pytest.raises(IndexError):
                view[start]


def test_places_that_no_file_has(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(b"abc")
    with (tmp_path / "x").open("rb") as file:
        assert FileBytes(file)[1 << 70 : (1 << 70) + 8] == b""
        assert FileBytes(file)[1 : 1 << 70] == b"bc"
