"""Entry point of `sgi` and `python -m sgicodec`."""

import sys

from sgicodec.errors import MissingExtraError, require


def main() -> None:
    """Runs the command line; in one line it says if the library that parses it is missing, or if it is interrupted
    while it loads.
    """
    try:
        require("click", "the command line")
        from sgicodec.cli.main import main as run

        run()
    except MissingExtraError as error:
        print(f"sgi: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        print("sgi: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
