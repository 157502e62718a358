"""`python -m sgicodec` is `sgi`."""

from sgicodec.cli.main import main

if __name__ == "__main__":
    main()
