"""The benchmark of decoding: that its stages cover a decode, and what it counts."""

from pathlib import Path

from click.testing import CliRunner

from benchmarks.latency import STAGES, Work, main, measure, stage_times
from sgicodec import open_stream
from sgicodec.bitstream.entropy.symbol_coder import SymbolReader
from sgicodec.decoder import stream as decoder

STREAM = Path(__file__).parents[2] / "conformance" / "golden" / "rgb8.sgi"


def test_stages_are_all_seen_and_hold_nearly_all_of_the_time() -> None:
    breakdown = measure(STREAM, threads=1, repeat=3)
    assert set(breakdown.stages) == set(STAGES)
    assert all(seconds > 0 for seconds in breakdown.stages.values())
    assert 0.5 * breakdown.least < sum(breakdown.stages.values()) <= 1.5 * breakdown.total


def test_functions_are_put_back() -> None:
    before = decoder.open_stream, SymbolReader.code
    with stage_times() as spent:
        assert decoder.open_stream is not before[0]
        decoder.open_stream(STREAM).picture(threads=1)
    assert before == (decoder.open_stream, SymbolReader.code)
    assert set(spent) == set(STAGES)


def test_work_is_counted() -> None:
    with open_stream(STREAM) as stream:
        work = Work.of(stream)
        seeds = len(stream.model.layout)
    assert work.network == seeds * (64 * (32 + 39 + 44) + 64 * (7 + 7 + 5))
    assert work.symbols > 8 * seeds  # and the quadtree's, the base layer's and the differences to the prior
    assert (work.stream_bytes, work.sample_bytes) == (STREAM.stat().st_size, 192 * 128 * 3)
    assert work.pairs > 100 * seeds
    assert work.range_decoder > 0


def test_the_command_prints_a_table() -> None:
    arguments = [str(STREAM), "--threads", "1", "--isa", "portable", "--repeat", "1", "--no-cold"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert lines[0].startswith("192×128 pixels, ")
    assert lines[2] == "portable, 1 thread, median of 1 runs"
    assert [line.count("|") for line in lines[4:]] == [4] * (len(STAGES) + 4)
