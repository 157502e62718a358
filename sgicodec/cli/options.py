"""Options that several commands share, and what their values look like."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import click

from sgicodec.rate_control.target import TARGETS

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

VERBOSE = "sgicodec.verbose"
"""Key in a context's `meta`: whether -v was given."""

_Command = TypeVar("_Command", bound=click.Command)


class _Value(click.ParamType):  # type: ignore[type-arg]
    """What `read` makes of a text, None or a ValueError where that makes no sense; `name` is what help shows."""

    def __init__(self, name: str, example: str, read: Callable[[str], Any]) -> None:
        self.name, self._example, self._read = name, example, read

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Called by click. Values that were converted before are left alone."""
        try:
            found = self._read(value) if isinstance(value, str) else value
        except ValueError:
            found = None
        return (
            found
            if found is not None
            else self.fail(f"{value!r} is not {self.name}, as in {self._example}", param, ctx)
        )


def _pattern(name: str, pattern: str, example: str, read: Callable[[re.Match[str]], Any]) -> _Value:
    """A value that is read from the groups of a regular expression."""
    compiled = re.compile(pattern)
    return _Value(name, example, lambda text: (found := compiled.fullmatch(text.strip())) and read(found))


_STDOUT = ("/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")
"""Names of what `-` stands for as OUT."""


class _Name(click.ParamType):  # type: ignore[type-arg]
    """The name of a file or a folder: not empty, as an unset variable of the shell is. kind: "file" or "dir", which the
    shell completes.
    """

    name = "name"

    def __init__(self, kind: str) -> None:
        self._kind = kind

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Called by click."""
        if value == "":
            self.fail("the name is empty", param, ctx)
        return "-" if value in _STDOUT else value

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Called by click."""
        from click.shell_completion import CompletionItem

        return [CompletionItem(incomplete, type=self._kind)]


FILE, FOLDER = _Name("file"), _Name("dir")


def _region(found: re.Match[str]) -> tuple[int, ...]:
    return tuple(int(part) for part in found.groups())


def _scale(found: re.Match[str]) -> float | None:
    above, below = (float(part or 1) for part in found.groups()[:2])
    below *= 100 if found[3] == "%" else 1
    return above / below if below and 0 < above / below < math.inf else None


class Sized(NamedTuple):
    """A size in pixels; a side that is None follows from the other. exact: whether the aspect may change."""

    width: int | None
    height: int | None
    exact: bool = False


def _size(found: re.Match[str]) -> Sized | None:
    width, height = (int(part) if part else None for part in found.groups()[:2])
    exact = bool(found[3])
    lacks = (width is height is None) or (exact and None in (width, height))
    return None if lacks or 0 in (width, height) else Sized(width, height, exact)


def _sample_range(found: re.Match[str]) -> str | tuple[float, float] | None:
    if found[0] in ("used", "type"):
        return found[0]
    low, high = (float(part) for part in found.groups())
    return (low, high) if -math.inf < low < high < math.inf else None


def _bytes(found: re.Match[str]) -> float | None:
    number, prefix, binary = found.groups()
    size = float(number) * (1024 if binary else 1000) ** " kmg".index((prefix or " ").lower())
    return size if 1 <= size < math.inf else None


_NUMBER = r"(\d+\.?\d*|\.\d+)"

REGION = _pattern("X,Y,W,H", r"(-?\d+) ?, ?(-?\d+) ?, ?(\d+) ?, ?(\d+)", "100,50,256,256", _region)
BYTES = _pattern("BYTES", rf"{_NUMBER} ?(?:([kKmMgG])(i?))?B?", "20000, 200kB or 1.5MiB", _bytes)
SCALE = _pattern("F", rf"{_NUMBER}(?:(?:/{_NUMBER})?| ?([%xX×]))", "0.5, 1/4 or 50%", _scale)
SIZE = _pattern("WxH", r"(\d*) ?[xX×] ?(\d*)(!?)", "512x384, 512x, x384 or 512x384!, or --scale 50%", _size)
QUALITY = _Value("a number from 1 to 100", "90 (visually lossless), 65 (web) or 40 (preview)", float)
EFFORT = _Value("a valid integer from 1 to 9", "2 (fast), 5 or 9 (smallest)", int)
SAMPLE_RANGE = _pattern(
    "used, type or LOW,HIGH", r"used|type|([^,]+),([^,]+)", "used, 0,4095 or -40,1500.5", _sample_range
)


def verbose_option(command: _Command) -> _Command:
    """Adds -v to a command: `ctx.meta[VERBOSE]`, which all commands and the error report of the group read."""

    def remember(ctx: click.Context, param: click.Parameter, value: bool) -> None:
        ctx.meta[VERBOSE] = value

    text = "Tell more; print the trace of an internal error."
    return click.option("-v", "--verbose", is_flag=True, expose_value=False, callback=remember, help=text)(command)


threads_option = click.option(
    "-j",
    "--threads",
    default=0,
    show_default="all cores",
    type=click.IntRange(0, 1024),
    metavar="N",
    help="Number of threads.",
)
device_option = click.option(
    "--device",
    default="cpu",
    show_default=True,
    metavar="NAME",
    help="What fits: cpu, cuda or cuda:N for a GPU, auto for one if there is.",
)
alpha_option = click.option(
    "--alpha",
    type=click.Choice(["auto", "band", "none"]),
    default="auto",
    show_default=True,
    help="Take for alpha what the file declares so; code it as a band like the others; or leave it out.",
)
page_option = click.option(
    "--page", type=int, metavar="N", help="Page of a file with several, from 1.  [default: the first]"
)
output_option = click.option(
    "-o", "--output", type=FILE, metavar="OUT", help="Write to this file, whatever it is called."
)
progress_option = click.option(
    "--progress",
    type=click.Choice(["auto", "on", "off"]),
    default="auto",
    show_default=True,
    help="Bar on stderr; auto on a terminal only.",
)
quiet_option = click.option("--quiet", is_flag=True, help="Print errors only.")


def target_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds an option for each target that a stream may end at."""
    for name, target in reversed(TARGETS.items()):
        kind = BYTES if name == "size" else _Value(target.noun, target.example, float)
        command = click.option(f"--{name}", type=kind, metavar=target.metavar, help=target.help)(command)
    return command


def batch_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options for many files by one command."""
    for option in (
        click.option("--skip-existing", is_flag=True, help="Leave out what has its OUT already."),
        click.option("-r", "--recursive", is_flag=True, help="Take all files in folders IN and their subfolders."),
        click.option("--output-dir", type=FOLDER, metavar="DIR", help="Take all IN, and write into this folder."),
    ):
        command = option(command)
    return command


force_option = click.option("-f", "--force", is_flag=True, help="Overwrite what OUT names; write to a terminal.")
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
