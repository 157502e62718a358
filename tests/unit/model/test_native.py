"""The native context model against docs/format.md, "Context model", one seed at a time in Python's integers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.device import ONE_THREAD, Device
from sgicodec.model.context import LEVELS, level_inputs, nearest_by_pass, output_columns, output_count
from sgicodec.model.layout import SeedLayout, adaptive_layout
from sgicodec.model.native import Quantisers, SeedInputs, quantisers, summarise, write_own_inputs
from sgicodec.model.neighbours import nearest_seeds
from sgicodec.model.network import Prediction
from sgicodec.model.quantization import STEP_COUNT, step_fixed
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, default_plan
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

ONE = 1 << 24
SPECS = [default_spec(3), default_spec(1), default_spec(5), default_spec(4)]
DETAIL = np.random.default_rng(0).normal(size=(3, 90, 150)) * np.linspace(0, 1, 150) ** 2
LAYOUT = adaptive_layout(DETAIL.astype(np.float32), 5.0)
every_spec = pytest.mark.parametrize("spec", SPECS)
threads = pytest.mark.parametrize("threads", [1, 2])


def root(value: int, degree: int) -> int:
    """Floor of the degree-th root, exactly."""
    low, high = 0, 1 << (value.bit_length() // degree + 1)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle**degree <= value else (low, middle)
    return low


def clip(value: int, limit: int) -> int:
    return min(max(value, -limit), limit)


def exact_amplitude(values: list[int]) -> int:
    """⌊3 log2 E⌋ − 72: the largest t with 2^t ≤ E³, in integers."""
    energy = max(1, sum(clip(v >> 12, 2**20) ** 2 for v in values))
    return (energy**3).bit_length() - 1 - 72


def exact_summary(spec: ModelSpec, row: list[int]) -> list[int]:
    """Numbers in input units from the decoded attributes of one seed."""
    channels = spec.channels
    colour, shape = row[:channels], row[channels : channels + 3]
    colours = [value >> 14 for value in colour[: 3 if channels >= 3 else 1]]
    colours += [0] * (3 - len(colours))
    loudness = exact_amplitude(colour) * 64 // 6 + 384
    shapes = [value >> 18 for value in shape]
    return [clip(value, 2**13) for value in (*colours, loudness, *shapes)]


@every_spec
@threads
def test_summaries(spec: ModelSpec, threads: int) -> None:
    rng = np.random.default_rng(spec.channels)
    size = 2.0 ** rng.uniform(4, 34, (2500, 1))
    decoded = np.rint(rng.normal(size=(2500, spec.attributes)) * size).astype(np.int64)
    members = rng.permutation(2500)[:2100]
    summary, amplitude = summarise(spec, decoded, members, Device(threads))
    rows = decoded[members].tolist()
    assert summary.tolist() == [exact_summary(spec, row) for row in rows]
    assert amplitude.tolist() == [exact_amplitude(row[: spec.channels]) for row in rows]


def amplitude_of(values: list[int]) -> int:
    """By the native code: `values` are the colours of the one Gaussian of one seed."""
    spec = default_spec(len(values))
    decoded = np.array([values + [0] * (spec.attributes - len(values))], np.int64)
    return int(summarise(spec, decoded, np.zeros(1, np.int64), ONE_THREAD)[1][0])


@given(st.lists(st.integers(-(2**40), 2**40), min_size=1, max_size=12))
def test_amplitude_index_is_exact(values: list[int]) -> None:
    assert amplitude_of(values) == exact_amplitude(values)


@given(st.lists(st.integers(-(2**15), 2**15), min_size=1, max_size=4))
def test_small_amplitudes(values: list[int]) -> None:
    assert amplitude_of(values) == exact_amplitude(values)


@pytest.mark.parametrize("offset", [-1, 0, 1, 2])
def test_amplitude_index_at_every_boundary(offset: int) -> None:
    """Energies on both sides of 2^(third / 3), as sums of squares."""
    for third in range(127):
        energy = max(1, root(2**third, 3) + offset)
        parts, rest = [], energy
        while rest:
            parts.append(min(math.isqrt(rest), 2**20))
            rest -= parts[-1] ** 2
        assert amplitude_of([part << 12 for part in parts]) == (energy**3).bit_length() - 73


def test_amplitude_index_measures_amplitude() -> None:
    for values in ([0.1, 0.0, 0.0], [1.0, 1.0, 1.0]):
        expected = math.floor(6 * math.log2(math.hypot(*values)))
        assert amplitude_of([int(value * ONE) for value in values]) == expected
    assert amplitude_of([0, 0, 0]) == -72


def exact_neighbour_inputs(layout: SeedLayout, summary: list[list[int]], seed: int, ranks: list[int]) -> list[int]:
    centre, sizes = layout.half_pixels.astype(int).tolist(), layout.log_size.tolist()
    weighted = list(zip((4, 3, 3, 2, 2, 2), [i for i in ranks if i >= 0], strict=False))
    k = sizes[seed]
    row = [sum(64 * w for w, _ in weighted) >> 4]
    row += [sum(w * summary[i][j] for w, i in weighted) >> 4 for j in range(7)]
    row += [sum(w * abs(summary[i][j]) for w, i in weighted) >> 4 for j in (0, 1, 2, 5, 6)]
    row += [sum(64 * w * (sizes[i] - k) for w, i in weighted) >> 4]
    if not weighted:
        return row + [0] * 9
    nearest = weighted[0][1]
    away = [centre[nearest][d] - centre[seed][d] for d in (0, 1)]
    return row + summary[nearest] + [clip((64 * d) >> (k + 1), 512) for d in away]


@threads
def test_inputs_of_seeds(threads: int) -> None:
    """Of every pass, with seeds that have all neighbours, some and none; in rows wider than what is written."""
    context = default_spec(3).context
    for layout in (LAYOUT, LAYOUT.take(np.arange(9)), LAYOUT.take(np.arange(1))):
        inputs = SeedInputs(layout, 90, Device(threads))
        inputs.summary[:] = np.random.default_rng(5).integers(-(2**13), 2**13 + 1, inputs.summary.shape)
        expected_level = level_inputs(layout, 90).tolist()
        for members, neighbours in nearest_by_pass(context, layout, nearest_seeds):
            out = np.full((len(members), 36), 77, np.int16)
            inputs.write(members, neighbours, out)
            for row, seed, ranks in zip(out.tolist(), members.tolist(), neighbours.tolist(), strict=True):
                beside = exact_neighbour_inputs(layout, inputs.summary.tolist(), seed, ranks)
                assert row == expected_level[seed] + beside + [77] * 4
    alone = np.empty((len(LAYOUT), LEVELS + 1), np.int16)
    everyone = np.arange(len(LAYOUT))
    SeedInputs(LAYOUT, 200, Device(threads)).write(everyone, np.empty((len(LAYOUT), 0), np.int32), alone)
    np.testing.assert_array_equal(alone, level_inputs(LAYOUT, 200))


@threads
@pytest.mark.parametrize("step", [1, 2])
def test_own_inputs(threads: int, step: int) -> None:
    summary = np.random.default_rng(2).integers(-(2**13), 2**13 + 1, (1300, 7)).astype(np.int16)
    out = np.full((1300, 50), 77, np.int16)
    write_own_inputs(summary, step, 32, out, Device(threads))
    for row, (a, b, c, loudness, *shape) in zip(out.tolist(), summary.tolist(), strict=True):
        expected = [a, b, c, abs(a), abs(b), abs(c), loudness]
        expected += [*shape, abs(shape[1]), abs(shape[2])] if step == 2 else []
        assert row == [77] * 32 + expected + [77] * (18 - len(expected))
    with pytest.raises(ValueError, match="room"):
        write_own_inputs(summary, step, 44, out, Device(threads))


def exact_quantiser(
    bases: list[int], gamma: int | None, amplitude: int, mean: int, scale: int, refine: int, log_size: int
) -> tuple[int, int, int]:
    """Mean, step and scale index of one attribute, bases by cell size."""
    b = bases[min(max(log_size, 0), 7)]
    e = b + clip(refine, 24) - (0 if gamma is None else gamma * (amplitude + 20) >> 4)
    e = min(max(e, 0), 102)
    steps = step_fixed(np.arange(STEP_COUNT)).tolist()
    return clip(mean, 2**20) * steps[b] >> 8, steps[e], min(max(24 + scale + b - e, 0), 63)


@every_spec
@threads
@pytest.mark.parametrize("group", ["colour", "shape", "offset"])
def test_quantisers(spec: ModelSpec, threads: int, group: str) -> None:
    rng = np.random.default_rng(3)
    n, units = 1500, output_count(spec, group)
    plan = default_plan(spec, 60)
    base = rng.integers(0, STEP_COUNT, plan.base[group].shape)
    plan = StepPlan({**plan.base, group: base}, {**plan.gamma, group: int(rng.integers(0, 64))})
    mean = rng.integers(-(2**22), 2**22, (n, units))
    scale, refine = rng.integers(-90, 90, (n, units)), rng.integers(-60, 60, (n, 1))
    amplitude = rng.integers(-72, 60, n).astype(np.int32)
    log_size = rng.integers(0, 10, n).astype(np.int8)
    whole = np.concatenate([rng.integers(0, 9, (n, 1)), mean, scale, refine], axis=1)  # as outputs of MLP_p lie
    parts = whole[:, 1 : 1 + units], whole[:, 1 + units : 1 + 2 * units], whole[:, 1 + 2 * units :]
    for known in (amplitude, None):
        found = quantisers(spec, plan, group, Prediction(*parts), known, log_size, Device(threads))
        for j, unit in enumerate(output_columns(spec, group)):
            gamma = None if known is None else plan.gamma[group]
            rows = zip(amplitude, mean[:, unit], scale[:, unit], refine[:, 0], log_size, strict=True)
            expected = [exact_quantiser(base[unit].tolist(), gamma, *map(int, row)) for row in rows]
            columns = (found.mean[:, j], found.step[:, j], found.scale[:, j])
            assert list(zip(*(column.tolist() for column in columns), strict=True)) == expected


@threads
def test_values_from_symbols(threads: int) -> None:
    rng = np.random.default_rng(1)
    mean, step = rng.integers(-(2**40), 2**40, (1100, 3)), rng.integers(256, 2**25, (1100, 3))
    symbols = rng.integers(-(2**20), 2**20 + 1, (1100, 3)).astype(np.int32)
    members = rng.permutation(1300)[:1100]
    decoded = np.full((1300, 8), 5, np.int64)
    Quantisers(mean, step, np.zeros((1100, 3), np.int16)).decode(symbols, members, 4, decoded, Device(threads))
    expected = np.full((1300, 8), 5, np.int64)
    expected[members, 4:7] = mean + step * symbols
    np.testing.assert_array_equal(decoded, expected)


def test_what_does_not_fit_is_refused() -> None:
    spec = default_spec(3)
    decoded = np.zeros((4, spec.attributes), np.int64)
    with pytest.raises(ValueError, match="indices of seeds"):
        summarise(spec, decoded, np.array([4]), ONE_THREAD)
    with pytest.raises(ValueError, match="do not fit"):
        summarise(replace(spec, per_seed=2), decoded, np.array([0]), ONE_THREAD)
    out, nobody = np.empty((1, 40), np.int16), np.full((1, 6), len(LAYOUT), np.int32)
    with pytest.raises(ValueError, match="indices of seeds"):
        SeedInputs(LAYOUT, 5, ONE_THREAD).write(np.array([0]), nobody, out)


def test_paper_groups_have_a_column_each() -> None:
    spec = paper_spec(3, per_seed=2, features=6)
    plan, units = default_plan(spec, 0), output_count(spec, "scales")
    zeros = np.zeros((2, units), np.int64)
    mean = np.arange(2 * units).reshape(2, units) << 8
    found = quantisers(
        spec, plan, "scales", Prediction(mean, zeros, zeros[:, :1]), None, np.zeros(2, np.int8), ONE_THREAD
    )
    np.testing.assert_array_equal(found.mean, (mean >> 8) * ONE)
