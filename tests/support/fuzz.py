"""Changes streams at random and decodes them until time is up; run by hand: python tests/damage/fuzz.py --seconds 120

Each try must give a picture or an SgiError of one line within PATIENCE and MEMORY. Whatever else happens ends the run
and leaves the stream in --out. A run is repeated by its --seed.
"""

from __future__ import annotations

import argparse
import resource
import time
import warnings
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
from absurd import absurd_stream
from surgery import Parts, join, split, with_fields

from sgicodec import EncodeSettings, SgiError, encode_picture, read
from sgicodec.decoder.stream import open_stream

MEMORY = 1 << 31
"""Bytes of address space, of which torch, needed to make the first streams, takes half."""
PATIENCE = 10.0
"""Seconds for one try."""

PICTURE = Path(__file__).parents[1] / "data" / "kodim23.png"


def sources() -> list[bytes]:
    """A few small streams that differ in profile, size, channels and samples."""
    whole = read(PICTURE)
    crop = replace(whole, pixels=np.ascontiguousarray(whole.pixels[180:220, 100:164]))
    gray = replace(crop, pixels=crop.pixels[..., :1].copy(), channels="gray")
    floats = replace(crop, pixels=(crop.pixels / 50.0).astype(np.float32), sample_range=(-1.0, 6.0))
    default = EncodeSettings(steps=15, texture=False)
    textured = EncodeSettings(steps=15, quality=80)
    paper = EncodeSettings(profile="paper", steps=15, seeds=20, per_seed=2, features=6)
    jobs = [
        (crop, default),
        (crop, textured),
        (crop, paper),
        (gray, replace(default, per_seed=2)),
        (floats, replace(default, prior=0)),
    ]
    return [encode_picture(picture, settings).data for picture, settings in jobs]


def mutate(data: bytes, others: list[bytes], rng: np.random.Generator) -> bytes:
    """One or a few changes: to bytes, to header fields, or inside a chunk whose checksum is then made to fit; or a
    sound stream of a mad model.
    """
    kind = int(rng.integers(6))
    if kind == 5:
        return absurd_stream(rng)
    if kind == 0:
        return scramble(data, rng)
    if kind == 1:
        return with_fields(data, **random_fields(rng))
    parts = split(data)
    if kind == 2:
        parts = [(letter, scramble(payload, rng) if rng.random() < 0.4 else payload) for letter, payload in parts]
    elif kind == 3:
        parts = splice(parts, split(others[int(rng.integers(len(others)))]), rng)
    else:
        at = next(index for index, (letter, _) in enumerate(parts) if letter == "T")
        parts[at] = ("T", bytes(rng.integers(0, 256, int(rng.integers(0, 400)), np.uint8)))
        return with_fields(join(parts), **(random_fields(rng) if rng.random() < 0.7 else {}))
    return join(parts)


def scramble(data: bytes, rng: np.random.Generator) -> bytes:
    """Flips, overwrites, cuts, repeats or inserts at one to four places."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 5))):
        at, length = int(rng.integers(len(changed) + 1)), int(rng.geometric(0.2))
        kind = int(rng.integers(5))
        noise = bytes(rng.integers(0, 256, length, np.uint8))
        if kind == 0 and at < len(changed):
            changed[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            changed[at : at + length] = noise[: len(changed) - at]
        elif kind == 2:
            del changed[at : at + length]
        elif kind == 3:
            changed[at:at] = changed[at : at + length]
        else:
            changed[at:at] = noise
    return bytes(changed)


def splice(parts: Parts, others: Parts, rng: np.random.Generator) -> Parts:
    """Chunks of two streams, some lost, some swapped."""
    mixed = [part if rng.random() < 0.6 else others[int(rng.integers(len(others)))] for part in parts]
    if rng.random() < 0.3:
        i, j = rng.integers(len(mixed), size=2)
        mixed[i], mixed[j] = mixed[j], mixed[i]
    return [part for part in mixed if rng.random() < 0.95]


def random_fields(rng: np.random.Generator) -> dict[str, int]:
    """New values of some header fields, likelier small or near a power of two."""
    names = (
        *("width", "height", "channels", "layout", "sample_type", "seed_layout", "shape", "flags", "per_seed"),
        *("features", "hidden", "base_cell", "quality", "family", "prior", "context_hidden", "neighbours"),
    )
    chosen = rng.choice(names, min(6, int(rng.geometric(0.5))), replace=False)
    return {str(name): int(rng.integers(0, 2 ** int(rng.integers(1, 26)))) for name in chosen}


def attempt(data: bytes) -> str:
    """What came of a stream: "picture" or the name of the error. Raises whatever is no SgiError."""
    try:
        with open_stream(data) as stream:
            size = (min(stream.width, 256), min(stream.height, 256))
            stream.picture((0, 0, *size))
            stream.picture((0, 0, *size), size=(50, 40))
            return "picture"
    except SgiError as error:
        if "\n" in str(error):
            raise ValueError("a message of several lines") from error
        return type(error).__name__


def timed_attempt(data: bytes) -> tuple[str, float]:
    """`attempt` and its seconds; raises TimeoutError for too many."""
    started = time.monotonic()
    outcome = attempt(data)
    seconds = time.monotonic() - started
    if seconds > PATIENCE:
        raise TimeoutError(f"{seconds:.1f} seconds")
    return outcome, seconds


def main() -> None:
    """Runs until time is up or something is found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("fuzz-out"))
    arguments = parser.parse_args()
    warnings.simplefilter("error")
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    streams = sources()
    rng, outcomes, slowest = np.random.default_rng(arguments.seed), Counter[str](), 0.0
    end = time.monotonic() + arguments.seconds
    while time.monotonic() < end:
        data = mutate(streams[int(rng.integers(len(streams)))], streams, rng)
        try:
            outcome, seconds = timed_attempt(data)
        except BaseException:
            arguments.out.mkdir(exist_ok=True)
            path = arguments.out / f"found-{arguments.seed}-{outcomes.total()}.sgi"
            path.write_bytes(data)
            print(f"after {outcomes.total()} tries: {path}")
            raise
        outcomes[outcome] += 1
        slowest = max(slowest, seconds)
    print(f"{outcomes.total()} tries, slowest {slowest:.2f} s:", dict(outcomes))


if __name__ == "__main__":
    main()
