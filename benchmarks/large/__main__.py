"""`python -m benchmarks.large`."""

import sys

from benchmarks.large.command import main
from sgicodec.errors import SgiError

if __name__ == "__main__":
    try:
        main()
    except SgiError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
