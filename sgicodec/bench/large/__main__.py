"""`python -m sgicodec.bench.large`."""

import sys

from sgicodec.bench.large.command import main
from sgicodec.errors import SgiError

if __name__ == "__main__":
    try:
        main()
    except SgiError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
