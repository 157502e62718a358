"""The published figures agree with each other where the paper says the same thing twice."""

from __future__ import annotations

import pytest

from benchmarks.paper import published


def test_a_mb_of_the_paper_is_a_mebibyte() -> None:
    assert pytest.approx(106.81, abs=0.01) == 8 * 4 * 3_500_000 / 2**20  # LIG, Table 1


@pytest.mark.parametrize(("count", "total"), [(3_500_000, 16.3324), (7_000_000, 31.1268), (10_000_000, 41.7439)])
def test_components_sum_to_the_printed_size(count: int, total: float) -> None:
    assert sum(published.COMPONENTS[count].values()) == pytest.approx(total, abs=0.0002)


def test_the_usual_settings_are_one_model() -> None:
    usual = published.PER_SEED["10"], published.LAMBDA["0.001"], published.LEVELS["3"]
    assert {row.psnr for row in usual} == {(31.24, 35.27)}
    assert usual[0].mib == usual[1].mib
    assert usual[0].minutes == usual[2].minutes
    assert usual[0].mib is not None
    assert sum(published.COMPONENTS[3_500_000].values()) == pytest.approx(usual[0].mib[0], abs=0.01)


def test_exact_fits_are_those_of_lambda_zero() -> None:
    by_pictures = {row.pictures: row.psnr for row in published.EXACT if row.method.startswith("SGI")}
    assert (by_pictures["FGF2"], by_pictures["ICB"]) == published.LAMBDA["0"].psnr
