"""What each table takes: settings as published, Gaussians that suit the picture, and nothing measured twice."""

from __future__ import annotations

import click
import pytest

from benchmarks.paper import published
from benchmarks.paper.jobs import RATES, TABLES, Job, Method, PaperFit, Scope, jobs
from sgicodec.cli.encode import encode

PIXELS_2K = 2048 * 1363
SCOPE = Scope(15_000)


def fits(table: str, scope: Scope = SCOPE) -> dict[str, PaperFit]:
    return {job.setting: job.fit for job in jobs(table, PIXELS_2K, scope) if job.method is Method.PAPER}


def test_a_2k_picture_has_the_papers_numbers() -> None:
    assert [10 * fit.seeds for fit in fits("comparison").values()] == [50_000, 370_000, 1_200_000]
    assert fits("decode")["low"] == fits("comparison")["low"] == PaperFit(5000, 15_000)
    assert [job.fit.seeds for job in jobs("exact", PIXELS_2K, SCOPE)] == [1000, 5000]


@pytest.mark.parametrize(
    ("table", "known"),
    [("per-seed", published.PER_SEED), ("lambda", published.LAMBDA), ("levels", published.LEVELS)],
)
def test_ablations_have_the_settings_of_the_paper(table: str, known: dict[str, object]) -> None:
    assert list(fits(table)) == list(known)


def test_gaussians_stay_where_k_changes_and_d_follows() -> None:
    of_k = fits("per-seed")
    assert all(abs(fit.seeds * fit.per_seed - 50_000) <= fit.per_seed for fit in of_k.values())
    assert [fit.features for fit in of_k.values()] == [25, 50, 75, 100]
    assert fits("per-seed")["10"] == fits("lambda")["0.001"] == fits("levels")["3"] == fits("rate-distortion")["1"]


def test_seeds_and_rates_may_be_chosen() -> None:
    scope = Scope(60, seeds=700, rates=("medium",))
    assert [fit.seeds for fit in fits("components", scope).values()] == [700, 1400, 2000]
    assert list(fits("comparison", scope)) == ["medium"]


def test_options_are_those_of_the_command_and_of_the_library() -> None:
    fit = PaperFit(700, 60, per_seed=5, lmbda=0.0005, levels=2)
    context = click.Context(encode)
    values, _, _ = encode.make_parser(context).parse_args([*fit.options(), "in.png"])
    settings = fit.settings()
    for name in ("profile", "tile", "seeds", "steps", "per_seed", "features", "levels", "lmbda"):
        assert str(values[name]) == str(getattr(settings, name)), name


def test_no_phase_has_noise_where_no_bit_counts() -> None:
    phases = PaperFit(100, 15_000, lmbda=0.0).settings().fit_settings().phases
    assert [(phase.steps, phase.level) for phase in phases] == [(3000, 2), (6000, 1), (6000, 0)]
    assert {(phase.rounding, phase.rate, phase.learn_steps) for phase in phases} == {("none", False, False)}


@pytest.mark.parametrize("table", TABLES)
def test_every_job_has_a_row_of_its_own(table: str) -> None:
    of_table = jobs(table, PIXELS_2K, SCOPE)
    keys = [job.key("a.png", "crc") for job in of_table]
    assert len(set(keys)) == len(keys)
    goals = [goal for job in of_table if (goal := job.beside()) is not None]
    assert {goal.key("a.png", "crc") for goal in goals} <= set(keys)


def test_enlarged_pictures_are_other_measurements() -> None:
    plain, enlarged = (Job("decode", "low", PaperFit(5, 60), factor=factor) for factor in (0, 8))
    assert plain.key("a", "b")[-1] != enlarged.key("a", "b")[-1]
    assert min(RATES.values()) == RATES["low"]
